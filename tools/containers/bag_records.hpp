// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The records of a ROS 1 bag (version 2.0), after wiki.ros.org/Bags/Format/2.0: a header of named
// fields, then data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/byte_reader.hpp"

namespace adit::bag {

inline constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
inline constexpr std::size_t kFileHeader = 4096;  ///< bytes of the first record, padded

enum class Opcode : uint8_t {
  message = 0x02,
  file_header = 0x03,
  index = 0x04,
  chunk = 0x05,
  chunk_info = 0x06,
  connection = 0x07,
};

/// The fields of a record's header, raw.
class Fields {
 public:
  /// Takes "name=value" fields up to the end of `header`.
  explicit Fields(ByteReader header);

  /// The number in a field. Throws InputError where it is missing or of another size.
  template <class T>
  T number(const std::string& name) const {
    return value(name, sizeof(T)).number<T>(name);
  }
  Nanoseconds time(const std::string& name) const;
  std::string text(const std::string& name) const;
  bool has(const std::string& name) const { return fields_.contains(name); }
  std::optional<Opcode> opcode() const;

 private:
  ByteReader value(const std::string& name, std::size_t size) const;

  ByteReader origin_;  // for messages
  std::map<std::string, ByteReader> fields_;
};

/// Seconds and nanoseconds, 32 bits each.
Nanoseconds read_time(ByteReader& reader);

/// A topic and what is recorded about it.
struct Connection {
  uint32_t id = 0;
  std::string topic;
  std::string type;
  std::string definition;
  std::map<std::string, std::string> metadata;  ///< md5sum, callerid, latching: as far as recorded
};
/// From the header and the data of its record.
Connection read_connection(const Fields& header, const ByteReader& data);

}  // namespace adit::bag
