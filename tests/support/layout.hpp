// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Compares a struct of shaders/shared/*.h as C++ lays it out with what the shaders say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "adit/engine/vulkan/spirv.hpp"
#include "adit/shaders/embedded.hpp"

namespace adit::test {

struct Field {
  std::string_view name;
  std::size_t offset;
};

/// Every use of the struct in every shader, by its GLSL name.
inline std::vector<engine::StructLayout> layouts_in_shaders(std::string_view name) {
  std::vector<engine::StructLayout> found;
  for (const std::string_view shader : shaders::names_debug()) {
    for (engine::StructLayout& layout : engine::reflect(shaders::find_debug(shader)).structs) {
      if (layout.name == name) {
        found.push_back(std::move(layout));
      }
    }
  }
  return found;
}

/// Names, order and offsets of all members; the stride of every array of the struct, or where it is
/// in none its size. Fails if no shader uses the struct.
inline void expect_layout(std::string_view name, std::size_t size,
                          std::initializer_list<Field> fields) {
  SCOPED_TRACE("struct " + std::string(name));
  const std::vector<engine::StructLayout> found = layouts_in_shaders(name);
  EXPECT_FALSE(found.empty()) << "no shader uses it";
  for (const engine::StructLayout& layout : found) {
    ASSERT_EQ(layout.members.size(), fields.size());
    std::size_t i = 0;
    for (const Field& field : fields) {
      EXPECT_EQ(layout.members[i].name, field.name);
      EXPECT_EQ(layout.members[i].offset, field.offset) << field.name;
      ++i;
    }
    EXPECT_EQ(layout.end(), size);
    for (const uint32_t stride : layout.array_strides) {
      EXPECT_EQ(stride, size) << "array stride";
    }
  }
}

template <class T>
void expect_layout(std::string_view name, std::initializer_list<Field> fields) {
  expect_layout(name, sizeof(T), fields);
}

}  // namespace adit::test
