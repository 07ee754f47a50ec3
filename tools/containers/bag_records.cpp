// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/bag_records.hpp"

#include <utility>

namespace adit::bag {
namespace {

constexpr int64_t kSecond = 1'000'000'000;

std::string text_in(ByteReader value) {
  const std::span<const std::byte> bytes = value.bytes(value.remaining(), "a field");
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Fields::Fields(ByteReader header) : origin_(header) {
  while (header.remaining() > 0) {
    const auto length = header.number<uint32_t>("a field of a record's header");
    ByteReader field = header.part(length, "a field of a record's header");
    std::string name;
    while (true) {
      if (field.remaining() == 0) {
        field.fail("a field of a record's header has no '='");
      }
      const char c = static_cast<char>(field.number<uint8_t>("a field's name"));
      if (c == '=') {
        break;
      }
      name += c;
    }
    fields_.emplace(std::move(name), field);
  }
}

ByteReader Fields::value(const std::string& name, std::size_t size) const {
  const auto found = fields_.find(name);
  if (found == fields_.end()) {
    origin_.fail("the header of a record has no field '" + name + "'");
  }
  if (found->second.remaining() != size) {
    found->second.fail("the field '" + name + "' has " + std::to_string(found->second.remaining()) +
                       " bytes, not " + std::to_string(size));
  }
  return found->second;
}

Nanoseconds Fields::time(const std::string& name) const {
  ByteReader reader = value(name, 2 * sizeof(uint32_t));
  return read_time(reader);
}

std::string Fields::text(const std::string& name) const {
  const auto found = fields_.find(name);
  return found == fields_.end() ? std::string() : text_in(found->second);
}

std::optional<Opcode> Fields::opcode() const {
  const auto found = fields_.find("op");
  if (found == fields_.end() || found->second.remaining() != 1) {
    return std::nullopt;
  }
  ByteReader reader = found->second;
  return static_cast<Opcode>(reader.number<uint8_t>("op"));
}

Nanoseconds read_time(ByteReader& reader) {
  const auto seconds = reader.number<uint32_t>("a time");
  const auto nanoseconds = reader.number<uint32_t>("a time");
  return Nanoseconds(seconds * kSecond + nanoseconds);
}

Connection read_connection(const Fields& header, const ByteReader& data) {
  const Fields told(data);
  Connection connection;
  connection.id = header.number<uint32_t>("conn");
  connection.topic = header.text("topic");
  connection.type = told.text("type");
  connection.definition = told.text("message_definition");
  for (const char* name : {"md5sum", "callerid", "latching"}) {
    if (told.has(name)) {
      connection.metadata[name] = told.text(name);
    }
  }
  return connection;
}

}  // namespace adit::bag
