// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The words of SPIR-V that reflect() understands: instructions, decorations, modes and storage
// classes with their numbers in the specification, and the operands of one instruction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "adit/engine/error.hpp"

namespace adit::engine::spirv {

inline constexpr uint32_t kMagic = 0x07230203;
inline constexpr uint32_t kMaxBound = 4'194'303;  // the specification's limit on ids

enum Op : uint32_t {
  kOpName = 5,
  kOpMemberName = 6,
  kOpEntryPoint = 15,
  kOpExecutionMode = 16,
  kOpTypeInt = 21,
  kOpTypeFloat = 22,
  kOpTypeVector = 23,
  kOpTypeMatrix = 24,
  kOpTypeImage = 25,
  kOpTypeSampledImage = 27,
  kOpTypeArray = 28,
  kOpTypeRuntimeArray = 29,
  kOpTypeStruct = 30,
  kOpTypePointer = 32,
  kOpConstant = 43,
  kOpSpecConstantTrue = 48,
  kOpSpecConstantFalse = 49,
  kOpSpecConstant = 50,
  kOpVariable = 59,
  kOpDecorate = 71,
  kOpMemberDecorate = 72,
  kOpExecutionModeId = 331,
};

enum Decoration : uint32_t {
  kSpecId = 1,
  kArrayStride = 6,
  kMatrixStride = 7,
  kNonWritable = 24,
  kBinding = 33,
  kDescriptorSet = 34,
  kOffset = 35,
};

inline constexpr uint32_t kModeLocalSize = 17;
inline constexpr uint32_t kModeLocalSizeId = 38;
inline constexpr uint32_t kModelGLCompute = 5;
inline constexpr uint32_t kClassUniformConstant = 0;
inline constexpr uint32_t kClassUniform = 2;
inline constexpr uint32_t kClassPushConstant = 9;
inline constexpr uint32_t kClassStorageBuffer = 12;
inline constexpr uint32_t kDimBuffer = 5;
inline constexpr uint32_t kSampled = 1;

/// Throws Error.
[[noreturn]] inline void fail(const std::string& what) {
  throw Error("SPIR-V module cannot be used: " + what);
}

/// The operands of one instruction; reading past its end is an error, not a crash.
class Operands {
 public:
  explicit Operands(std::span<const uint32_t> words) : words_(words) {}
  std::size_t size() const { return words_.size(); }
  uint32_t operator[](std::size_t i) const {
    if (i >= words_.size()) {
      fail("an instruction is cut short");
    }
    return words_[i];
  }
  /// The string that begins at this operand.
  std::string text(std::size_t from) const {
    std::string text;
    for (std::size_t i = from; i < words_.size(); ++i) {
      for (uint32_t shift = 0; shift < 32; shift += 8) {
        const char c = static_cast<char>((words_[i] >> shift) & 0xFFU);
        if (c == '\0') {
          return text;
        }
        text.push_back(c);
      }
    }
    fail("a name does not end");
  }

 private:
  std::span<const uint32_t> words_;
};

}  // namespace adit::engine::spirv
