// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Reads Protocol Buffers' wire format back, as its specification has it.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace adit::test {

class ProtobufFields {
 public:
  explicit ProtobufFields(std::string bytes) : bytes_(std::move(bytes)) {
    for (std::size_t at = 0; at < bytes_.size();) {
      const uint64_t key = varint(at);
      Field field{.number = static_cast<int>(key >> 3U)};
      const uint64_t wire = key & 7U;
      if (wire == 0) {
        field.value = varint(at);
      } else {
        const std::size_t size = wire == 1 ? 8 : wire == 5 ? 4 : wire == 2 ? varint(at) : 0;
        if (wire > 5 || wire == 3 || wire == 4 || size > bytes_.size() - at) {
          throw std::runtime_error("no protobuf message");
        }
        field.bytes = bytes_.substr(at, size);
        at += size;
      }
      fields_.push_back(std::move(field));
    }
  }
  explicit ProtobufFields(std::span<const std::byte> bytes)
      : ProtobufFields(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())) {}

  std::size_t count(int number) const { return all(number).size(); }
  int64_t integer(int number) const { return static_cast<int64_t>(only(number).value); }
  std::string text(int number) const { return only(number).bytes; }
  double real(int number) const { return as<double>(only(number).bytes); }
  uint32_t fixed(int number) const { return as<uint32_t>(only(number).bytes); }
  ProtobufFields part(int number) const { return ProtobufFields(only(number).bytes); }
  std::vector<ProtobufFields> parts(int number) const {
    std::vector<ProtobufFields> found;
    for (const Field& field : all(number)) {
      found.emplace_back(field.bytes);
    }
    return found;
  }

 private:
  struct Field {
    int number = 0;
    uint64_t value = 0;
    std::string bytes{};
  };

  uint64_t varint(std::size_t& at) const {
    uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes_.at(at++));
      value |= static_cast<uint64_t>(byte & 0x7FU) << shift;
      if (byte < 0x80U) {
        return value;
      }
    }
    throw std::runtime_error("a varint is too long");
  }
  template <class T>
  static T as(const std::string& bytes) {
    T value{};
    if (bytes.size() != sizeof(T)) {
      throw std::runtime_error("a number has another size");
    }
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }
  std::vector<Field> all(int number) const {
    std::vector<Field> found;
    for (const Field& field : fields_) {
      if (field.number == number) {
        found.push_back(field);
      }
    }
    return found;
  }
  Field only(int number) const {
    const std::vector<Field> found = all(number);
    if (found.size() != 1) {
      throw std::runtime_error("field " + std::to_string(number) + " is there " +
                               std::to_string(found.size()) + " times");
    }
    return found[0];
  }

  std::string bytes_;
  std::vector<Field> fields_;
};

}  // namespace adit::test
