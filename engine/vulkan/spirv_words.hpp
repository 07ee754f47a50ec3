// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The words of SPIR-V as reflect() reads them: the operands of one instruction, and the two numbers
// of the specification that Khronos' header (spirv/unified1/spirv.hpp11) has not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "adit/engine/error.hpp"

namespace adit::engine::spirv {

inline constexpr uint32_t kMaxBound = 4'194'303;  // the specification's limit on ids
inline constexpr uint32_t kSampled = 1;           // an image's operand: read through a sampler

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
