// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Types of Protocol Buffers messages, and how an MCAP file describes them to its readers.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace adit {

/// Types of fields; the values are those of descriptor.proto.
enum class ProtobufType {
  number = 1,  ///< double
  int64 = 3,
  int32 = 5,
  fixed32 = 7,
  boolean = 8,
  text = 9,
  message = 11,
  bytes = 12,
  enumeration = 14,
};

struct ProtobufField {
  int number = 0;
  std::string name;
  ProtobufType type = ProtobufType::number;
  std::string type_name{};  ///< of messages and enumerations, in full: "foxglove.Pose"
  bool repeated = false;
  bool optional = false;  ///< its absence tells from its being 0: proto3's `optional`
};

/// The values of an enumeration, numbered from 0.
struct ProtobufEnumeration {
  std::string name;  ///< within its message: "Level"
  std::vector<std::string> values;
};

struct ProtobufMessageType {
  std::string name;  ///< in full, with its package: "foxglove.Pose"
  std::vector<ProtobufField> fields;
  std::vector<ProtobufEnumeration> enumerations{};
};

/// The FileDescriptorSet (proto3) of a message type and of all that it is made of, as bytes. Each
/// type has a file of its own, named after it, whatever the root: the same type is described by the
/// same bytes everywhere. Throws std::logic_error where a type is not among those known.
std::string descriptor_set(std::span<const ProtobufMessageType> known, std::string_view root);

}  // namespace adit
