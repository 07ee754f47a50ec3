// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/protobuf_message.hpp"

#include <bit>

namespace adit {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");

constexpr unsigned kVarint = 0;
constexpr unsigned kEightBytes = 1;
constexpr unsigned kSized = 2;
constexpr unsigned kFourBytes = 5;

}  // namespace

void ProtobufMessage::varint(uint64_t value) {
  constexpr unsigned kMore = 0x80U;
  for (; value >= kMore; value >>= 7U) {
    bytes_ += static_cast<char>((value & (kMore - 1U)) | kMore);
  }
  bytes_ += static_cast<char>(value);
}

void ProtobufMessage::key(int field, unsigned wire_type) {
  varint((static_cast<uint64_t>(field) << 3U) | wire_type);
}

void ProtobufMessage::sized(int field, const void* data, std::size_t size) {
  key(field, kSized);
  varint(size);
  bytes_.append(static_cast<const char*>(data), size);
}

void ProtobufMessage::number(int field, double value) {
  key(field, kEightBytes);
  bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void ProtobufMessage::integer(int field, int64_t value) {
  key(field, kVarint);
  varint(static_cast<uint64_t>(value));
}

void ProtobufMessage::fixed(int field, uint32_t value) {
  key(field, kFourBytes);
  bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void ProtobufMessage::text(int field, std::string_view value) {
  sized(field, value.data(), value.size());
}

void ProtobufMessage::bytes(int field, std::span<const std::byte> value) {
  sized(field, value.data(), value.size());
}

void ProtobufMessage::message(int field, const ProtobufMessage& value) {
  sized(field, value.bytes_.data(), value.bytes_.size());
}

void ProtobufMessage::numbers(int field, std::span<const double> values) {
  sized(field, values.data(), values.size_bytes());
}

}  // namespace adit
