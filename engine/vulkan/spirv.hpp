// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a SPIR-V compute module says about itself. Reads the module as the specification lays it out
// (SPIR-V 1.6, section 2.3); no dependency.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace adit::engine {

/// The most buffers of each kind that one kernel binds on a baseline device.
inline constexpr uint32_t kMaxStorageBindings = 30;
inline constexpr uint32_t kMaxTexelBindings = 16;

/// A buffer of descriptor set 0: storage, or uniform texels.
struct BindingInfo {
  uint32_t binding = 0;
  bool read_only = false;  ///< declared readonly; texels always are
  bool texels = false;     ///< a uniform texel buffer of uint (utextureBuffer, usamplerBuffer)
};

struct StructMember {
  std::string name;           ///< empty unless compiled with -g
  uint32_t offset = 0;        ///< bytes
  uint32_t bytes = 0;         ///< 0 for a runtime array
  uint32_t array_stride = 0;  ///< bytes; 0 if the member is not an array
};

/// A struct with a memory layout, as shaders/shared/*.h declares them.
struct StructLayout {
  std::string name;  ///< empty unless compiled with -g
  std::vector<StructMember> members;
  /// Strides of the arrays of this struct in the module, bytes; empty if it is in none.
  std::vector<uint32_t> array_strides;

  uint32_t end() const;  ///< bytes up to the end of the last member
};

struct SpecConstant {
  uint32_t id = 0;             ///< constant_id
  uint32_t default_value = 0;  ///< its bits
};

struct Reflection {
  std::vector<BindingInfo> bindings;  ///< set 0, by ascending binding
  std::array<uint32_t, 3> local_size{1, 1, 1};
  std::array<std::optional<uint32_t>, 3>
      local_size_ids;                        ///< constant_id of each, where specialised
  uint32_t push_bytes = 0;                   ///< 0: no push constants
  std::vector<SpecConstant> spec_constants;  ///< by ascending id, each once
  std::vector<StructLayout> structs;
};

/// Throws Error where `words` is not a compute module of the kind this project builds (one entry
/// point, storage and texel buffers in set 0, push constants) or is cut short.
Reflection reflect(std::span<const uint32_t> words);

}  // namespace adit::engine
