// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/ros_codec.hpp"

#include <limits>

namespace adit::ros {
namespace {

constexpr std::size_t kEncapsulation = 4;  // bytes
constexpr int64_t kSecond = 1'000'000'000;

/// Bytes up to the next multiple of `size`.
std::size_t padding(std::size_t at, std::size_t size) {
  return (size - at % size) % size;
}

}  // namespace

Decoder::Decoder(Encoding encoding, std::span<const std::byte> bytes)
    : encoding_(encoding), bytes_(bytes) {
  if (encoding == Encoding::ros1) {
    return;
  }
  if (bytes.size() < kEncapsulation) {
    throw CodecError("it has " + std::to_string(bytes.size()) +
                     " bytes, fewer than the four that open a CDR message");
  }
  const auto representation =
      std::to_integer<unsigned int>(bytes[0]) << 8U | std::to_integer<unsigned int>(bytes[1]);
  if (representation > 1) {
    throw CodecError("its CDR representation is " + std::to_string(representation) +
                     "; 0 (big-endian) and 1 (little-endian) are known");
  }
  swap_ = representation == 0;
  bytes_ = bytes.subspan(kEncapsulation);
}

void Decoder::align(std::size_t size) {
  if (encoding_ == Encoding::cdr) {
    take(padding(at_, size));
  }
}

std::span<const std::byte> Decoder::take(std::size_t size) {
  if (size > remaining()) {
    throw CodecError("it ends " + std::to_string(size - remaining()) +
                     " bytes too early, at byte " + std::to_string(bytes_.size()));
  }
  const std::span<const std::byte> taken = bytes_.subspan(at_, size);
  at_ += size;
  return taken;
}

std::size_t Decoder::count(std::size_t least) {
  uint32_t value = 0;
  field(value);
  if (value > remaining() / least) {
    throw CodecError("it claims " + std::to_string(value) + " elements where " +
                     std::to_string(remaining()) + " bytes are left");
  }
  return value;
}

void Decoder::field(bool& value) {
  uint8_t byte = 0;
  field(byte);
  value = byte != 0;
}

void Decoder::field(std::string& value) {
  const std::size_t size = count(1);
  const std::span<const std::byte> text = take(size);
  value.assign(reinterpret_cast<const char*>(text.data()), size);
  if (encoding_ == Encoding::cdr && !value.empty() && value.back() == '\0') {
    value.pop_back();
  }
}

void Decoder::time(Nanoseconds& value) {
  int64_t seconds = 0;
  if (encoding_ == Encoding::ros1) {
    uint32_t whole = 0;
    field(whole);
    seconds = whole;
  } else {
    int32_t whole = 0;
    field(whole);
    seconds = whole;
  }
  uint32_t nanoseconds = 0;
  field(nanoseconds);
  value = Nanoseconds(seconds * kSecond + nanoseconds);
}

void Decoder::blob(std::span<const std::byte>& value) {
  value = take(count(1));
}

Encoder::Encoder(Encoding encoding) : encoding_(encoding) {
  if (encoding == Encoding::cdr) {
    bytes_ = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
    origin_ = kEncapsulation;
  }
}

void Encoder::align(std::size_t size) {
  if (encoding_ == Encoding::cdr) {
    bytes_.resize(bytes_.size() + padding(bytes_.size() - origin_, size));
  }
}

void Encoder::append(const void* data, std::size_t size) {
  const auto* begin = static_cast<const std::byte*>(data);
  bytes_.insert(bytes_.end(), begin, begin + size);
}

void Encoder::field(const std::string& value) {
  const std::size_t zero = encoding_ == Encoding::cdr ? 1 : 0;
  field(static_cast<uint32_t>(value.size() + zero));
  append(value.c_str(), value.size() + zero);
}

void Encoder::time(Nanoseconds value) {
  int64_t seconds = value.count() / kSecond;
  int64_t rest = value.count() % kSecond;
  if (rest < 0) {
    rest += kSecond;
    --seconds;
  }
  const bool ros1 = encoding_ == Encoding::ros1;
  const int64_t least = ros1 ? 0 : std::numeric_limits<int32_t>::min();
  const int64_t most = ros1 ? int64_t{std::numeric_limits<uint32_t>::max()}
                            : int64_t{std::numeric_limits<int32_t>::max()};
  if (seconds < least || seconds > most) {
    throw CodecError("the time " + std::to_string(seconds) + " s has no place in a " +
                     (ros1 ? "ROS 1" : "ROS 2") + " message");
  }
  if (ros1) {
    field(static_cast<uint32_t>(seconds));
  } else {
    field(static_cast<int32_t>(seconds));
  }
  field(static_cast<uint32_t>(rest));
}

void Encoder::blob(std::span<const std::byte> value) {
  field(static_cast<uint32_t>(value.size()));
  append(value.data(), value.size());
}

}  // namespace adit::ros
