// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "adit/engine/vulkan/spirv.hpp"

namespace adit::engine {

class Context;

/// The value of one specialization constant (its bits).
struct Specialization {
  uint32_t id = 0;     ///< constant_id in the shader
  uint32_t value = 0;  ///< its bits
};

/// SPIR-V of a compute shader, with a name for messages and profiles.
struct Shader {
  std::string_view name;            ///< for messages and profiles
  std::span<const uint32_t> spirv;  ///< words of the module
};

/// By convention constant_id 0 of every shader is its work-group size in x, and this is its
/// default. (The default in the shader does not count: glslang writes 1 for a size given by
/// local_size_x_id alone.)
inline constexpr uint32_t kDefaultLocalSize = 64;

/// A compute shader made ready for a device: a pipeline and what is checked at every dispatch.
/// Must outlive the recordings and submissions that use it; the context must outlive it.
class Kernel {
 public:
  /// `shader_name` is the file stem of shaders/*.comp. Throws std::logic_error for a shader or a
  /// constant that does not exist and for a work-group size the device cannot run, Error where the
  /// driver fails.
  Kernel(Context& context, std::string_view shader_name,
         const std::vector<Specialization>& specializations = {});
  /// A shader of the caller's own, as docs/adding_a_kernel.md says. Is not kept. Throws as above,
  /// and Error for what is no such module.
  Kernel(Context& context, const Shader& shader,
         const std::vector<Specialization>& specializations = {});
  Kernel(Kernel&&) noexcept;
  Kernel& operator=(Kernel&&) noexcept;
  ~Kernel();

  /// The shader's.
  std::string_view name() const;
  uint32_t local_size() const;  ///< invocations a group in x, as specialised
  /// What its SPIR-V declares: bindings, work-group size, push constants.
  const Reflection& reflection() const;
  /// Groups for one invocation an item: ceil(items / local_size()). A dispatch takes at most
  /// kMaxGroups.
  uint32_t groups_for(uint64_t items) const;

  struct State;
  const State& state() const { return *state_; }  ///< for the engine alone

 private:
  std::unique_ptr<State> state_;
};

}  // namespace adit::engine
