// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/protobuf_schema.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <stdexcept>

#include "adit/tools/containers/protobuf_message.hpp"

namespace adit {
namespace {

// Numbers of the fields of descriptor.proto.
constexpr int kSetFile = 1;
constexpr int kFileName = 1;
constexpr int kFilePackage = 2;
constexpr int kFileDependency = 3;
constexpr int kFileMessage = 4;
constexpr int kFileSyntax = 12;
constexpr int kMessageName = 1;
constexpr int kMessageField = 2;
constexpr int kMessageEnumeration = 4;
constexpr int kMessageOneOf = 8;
constexpr int kFieldName = 1;
constexpr int kFieldNumber = 3;
constexpr int kFieldLabel = 4;
constexpr int kFieldType = 5;
constexpr int kFieldTypeName = 6;
constexpr int kFieldOneOf = 9;
constexpr int kFieldOptional = 17;
constexpr int64_t kLabelOptional = 1;
constexpr int64_t kLabelRepeated = 3;

struct ProtobufName {
  std::string package;
  std::string type;
};

ProtobufName protobuf_name(const std::string& full) {
  const std::size_t dot = full.rfind('.');
  return {.package = full.substr(0, dot), .type = full.substr(dot + 1)};
}

/// "foxglove/Pose.proto"; Google's own are in lower case.
std::string proto_file_of(const std::string& full) {
  const ProtobufName name = protobuf_name(full);
  std::string folder = name.package;
  std::ranges::replace(folder, '.', '/');
  std::string file = name.type;
  if (name.package == "google.protobuf") {
    std::ranges::transform(file, file.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  }
  return folder + "/" + file + ".proto";
}

ProtobufMessage described(const ProtobufEnumeration& enumeration) {
  ProtobufMessage text;
  text.text(1, enumeration.name);
  for (std::size_t i = 0; i < enumeration.values.size(); ++i) {
    ProtobufMessage value;
    value.text(1, enumeration.values[i]);
    value.integer(2, static_cast<int64_t>(i));
    text.message(2, value);
  }
  return text;
}

/// JSON's names of fields are left out: protobufjs would call fields by them, and viewers look for
/// those of the schema. Optional fields each are the one member of a choice, which is how proto3
/// tells that they are.
ProtobufMessage described(const ProtobufMessageType& type) {
  ProtobufMessage message;
  message.text(kMessageName, protobuf_name(type.name).type);
  std::vector<std::string> choices;
  for (const ProtobufField& field : type.fields) {
    ProtobufMessage one;
    one.text(kFieldName, field.name);
    one.integer(kFieldNumber, field.number);
    one.integer(kFieldLabel, field.repeated ? kLabelRepeated : kLabelOptional);
    one.integer(kFieldType, static_cast<int64_t>(field.type));
    if (!field.type_name.empty()) {
      one.text(kFieldTypeName, "." + field.type_name);
    }
    if (field.optional) {
      one.integer(kFieldOneOf, static_cast<int64_t>(choices.size()));
      one.integer(kFieldOptional, 1);
      choices.push_back("_" + field.name);
    }
    message.message(kMessageField, one);
  }
  for (const ProtobufEnumeration& enumeration : type.enumerations) {
    message.message(kMessageEnumeration, described(enumeration));
  }
  for (const std::string& choice : choices) {
    ProtobufMessage one;
    one.text(1, choice);
    message.message(kMessageOneOf, one);
  }
  return message;
}

/// Puts files into a set, each behind those that it depends on.
class DescriptorSet {
 public:
  explicit DescriptorSet(std::span<const ProtobufMessageType> known) : known_(known) {}

  void add(const std::string& name) {
    if (!added_.insert(name).second) {
      return;
    }
    const auto type = std::ranges::find(known_, name, &ProtobufMessageType::name);
    if (type == known_.end()) {
      throw std::logic_error("protobuf: no type " + name + " is known");
    }
    std::set<std::string> parts;
    for (const ProtobufField& field : type->fields) {
      if (field.type == ProtobufType::message) {
        parts.insert(field.type_name);
      }
    }
    for (const std::string& part : parts) {
      add(part);
    }
    ProtobufMessage file;
    file.text(kFileName, proto_file_of(name));
    file.text(kFilePackage, protobuf_name(name).package);
    for (const std::string& part : parts) {
      file.text(kFileDependency, proto_file_of(part));
    }
    file.message(kFileMessage, described(*type));
    file.text(kFileSyntax, "proto3");
    set_.message(kSetFile, file);
  }

  std::string bytes() const {
    return {reinterpret_cast<const char*>(set_.content().data()), set_.content().size()};
  }

 private:
  std::span<const ProtobufMessageType> known_;
  std::set<std::string> added_;
  ProtobufMessage set_;
};

}  // namespace

std::string descriptor_set(std::span<const ProtobufMessageType> known, std::string_view root) {
  DescriptorSet set(known);
  set.add(std::string(root));
  return set.bytes();
}

}  // namespace adit
