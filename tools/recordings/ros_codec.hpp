// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// ROS 1 serialisation and ROS 2's CDR (XCDR1, OMG DDS-XTypes 7.4), read and written. What a message
// consists of is stated once, in ros_visit.hpp, by a function that visits its fields in their
// order; here are the visitors.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/message_file.hpp"

namespace adit::ros {

/// What is wrong with the bytes of a message; whoever knows the file adds the place.
class CodecError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class T>
concept Number = std::is_arithmetic_v<T> && !std::same_as<T, bool>;

/// Takes a message apart. The layout differs in three things: CDR starts with four bytes that name
/// the byte order, aligns numbers to their size from the byte after those, and ends texts with a
/// zero that counts.
class Decoder {
 public:
  /// Throws CodecError where it is no CDR that is known.
  Decoder(Encoding encoding, std::span<const std::byte> bytes);

  Encoding encoding() const { return encoding_; }
  std::size_t remaining() const { return bytes_.size() - at_; }

  template <class... Fields>
  void operator()(Fields&... fields) {
    (field(fields), ...);
  }

  /// A point in time: seconds and nanoseconds.
  void time(Nanoseconds& value);
  /// Bytes behind a 32-bit count, as a view of the message.
  void blob(std::span<const std::byte>& value);
  /// Elements behind a 32-bit count; each takes at least `least` bytes.
  template <class T, class Visit>
  void sequence(std::vector<T>& values, std::size_t least, Visit&& visit) {
    values.resize(count(least));
    for (T& value : values) {
      visit(*this, value);
    }
  }

 private:
  template <Number T>
  void field(T& value) {
    align(sizeof(T));
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), take(sizeof(T)).data(), sizeof(T));
    if (swap_) {
      for (std::size_t i = 0; i < sizeof(T) / 2; ++i) {
        std::swap(raw[i], raw[sizeof(T) - 1 - i]);
      }
    }
    std::memcpy(&value, raw.data(), sizeof(T));
  }
  void field(bool& value);
  void field(std::string& value);
  template <Number T, std::size_t n>
  void field(std::array<T, n>& values) {
    for (T& value : values) {
      field(value);
    }
  }

  void align(std::size_t size);
  std::span<const std::byte> take(std::size_t size);
  std::size_t count(std::size_t least);

  Encoding encoding_;
  std::span<const std::byte> bytes_;  // without the encapsulation header
  bool swap_ = false;
  std::size_t at_ = 0;
};

/// Puts a message together, in little-endian.
class Encoder {
 public:
  explicit Encoder(Encoding encoding);

  Encoding encoding() const { return encoding_; }
  std::vector<std::byte> take() && { return std::move(bytes_); }

  template <class... Fields>
  void operator()(const Fields&... fields) {
    (field(fields), ...);
  }

  /// Throws CodecError where the encoding has no such time: ROS 1 counts from 1970 to 2106, ROS 2
  /// from 1901 to 2038.
  void time(Nanoseconds value);
  void blob(std::span<const std::byte> value);
  template <class T, class Visit>
  void sequence(const std::vector<T>& values, std::size_t, Visit&& visit) {
    field(static_cast<uint32_t>(values.size()));
    for (const T& value : values) {
      visit(*this, value);
    }
  }

 private:
  template <Number T>
  void field(T value) {
    align(sizeof(T));
    append(&value, sizeof(T));
  }
  void field(bool value) { field(static_cast<uint8_t>(value ? 1 : 0)); }
  void field(const std::string& value);
  template <Number T, std::size_t n>
  void field(const std::array<T, n>& values) {
    for (const T value : values) {
      field(value);
    }
  }

  void align(std::size_t size);
  void append(const void* data, std::size_t size);

  Encoding encoding_;
  std::size_t origin_ = 0;
  std::vector<std::byte> bytes_;
};

}  // namespace adit::ros
