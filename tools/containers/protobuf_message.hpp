// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Messages in Protocol Buffers' wire format (protobuf.dev/programming-guides/encoding), without its
// library: what is written is known to who writes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace adit {

/// A message put together field by field, in the order of the calls; `field` is its number, 1 to
/// 2^29 - 1. Zeros and empty texts are written, too, which readers of proto3 take as the absent
/// ones they mean. A field that is added again is repeated.
class ProtobufMessage {
 public:
  void number(int field, double value);
  /// int32, int64, uint32, uint64, bool and enumerations.
  void integer(int field, int64_t value);
  /// fixed32.
  void fixed(int field, uint32_t value);
  void text(int field, std::string_view value);
  void bytes(int field, std::span<const std::byte> value);
  void message(int field, const ProtobufMessage& value);
  /// A repeated double, packed.
  void numbers(int field, std::span<const double> values);

  /// What was written so far.
  std::span<const std::byte> content() const { return std::as_bytes(std::span(bytes_)); }

 private:
  void varint(uint64_t value);
  void key(int field, unsigned wire_type);
  void sized(int field, const void* data, std::size_t size);

  std::string bytes_;
};

}  // namespace adit
