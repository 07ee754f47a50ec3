// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"

namespace adit::engine {

/// The most groups of one dispatch on a baseline device.
inline constexpr uint32_t kMaxGroups = 65535;

/// Writes one command buffer: everything in it runs in one submission, in order of recording as far
/// as barrier() says so. Belongs to one thread. Nothing runs before Context::submit(); a recorder
/// that is dropped instead leaves no trace.
///
/// A call that does not fit the kernel (bindings, push constants, alignment, limits) is a mistake
/// in the program: std::logic_error names the kernel, what it expects and what was given. Slices
/// are bound to bindings 0, 1, ... of set 0 in their order, each as the shader declares it: as a
/// storage buffer, or as texels (whole ones of kTexelBytes, DeviceInfo::max_texel_buffer_elements
/// at most).
class Recorder {
 public:
  /// Device timestamps around its lifetime, if the context profiles. Must end before the recorder
  /// is submitted or moved.
  class [[nodiscard]] Scope {
   public:
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope();

   private:
    friend class Recorder;
    Scope(Recorder* recorder, uint32_t index) : recorder_(recorder), index_(index) {}
    Recorder* recorder_;  // null: not profiling
    uint32_t index_;
  };

  Recorder(Recorder&&) noexcept;
  Recorder& operator=(Recorder&&) noexcept;
  ~Recorder();

  /// `groups` groups of kernel.local_size() invocations, at most kMaxGroups; 0 groups record
  /// nothing. sizeof(Push) must be the size of the shader's push constants.
  template <class Push>
  void dispatch(const Kernel& kernel, uint32_t groups, const Push& push,
                std::initializer_list<Slice> slices) {
    dispatch_bytes(kernel, groups, bytes_of(push), {slices.begin(), slices.size()});
  }
  /// The same, of a shader without push constants.
  void dispatch(const Kernel& kernel, uint32_t groups, std::initializer_list<Slice> slices) {
    dispatch_bytes(kernel, groups, {}, {slices.begin(), slices.size()});
  }

  /// As many groups as the three uint32 at the start of `args` say when the device gets there.
  template <class Push>
  void dispatch_indirect(const Kernel& kernel, Slice args, const Push& push,
                         std::initializer_list<Slice> slices) {
    dispatch_indirect_bytes(kernel, args, bytes_of(push), {slices.begin(), slices.size()});
  }
  /// The same, of a shader without push constants.
  void dispatch_indirect(const Kernel& kernel, Slice args, std::initializer_list<Slice> slices) {
    dispatch_indirect_bytes(kernel, args, {}, {slices.begin(), slices.size()});
  }

  /// The same, for a number of slices or push constants known only at run time.
  void dispatch_bytes(const Kernel& kernel, uint32_t groups, std::span<const std::byte> push,
                      std::span<const Slice> slices);
  /// As above.
  void dispatch_indirect_bytes(const Kernel& kernel, Slice args, std::span<const std::byte> push,
                               std::span<const Slice> slices);

  /// Sets every 32-bit word; offset and length are multiples of 4 bytes.
  void fill(Slice slice, uint32_t value);
  /// Lengths are equal; the two do not overlap.
  void copy(Slice from, Slice to);
  /// What was recorded before has written before what is recorded after reads or writes: kernels,
  /// copies and indirect arguments. The start of a submission is such a barrier against all earlier
  /// submissions; its end makes writes visible to the host.
  void barrier();

  /// `name` must outlive the submission's results (a string literal).
  Scope scope(std::string_view name);

  struct State;

 private:
  friend class Context;
  explicit Recorder(std::unique_ptr<State> state);

  template <class Push>
  static std::span<const std::byte> bytes_of(const Push& push) {
    static_assert(std::is_trivially_copyable_v<Push>);
    return std::as_bytes(std::span<const Push, 1>(&push, 1));
  }
  void end_scope(uint32_t index);

  std::unique_ptr<State> state_;
};

/// Named device time, see Recorder::scope().
using Scope = Recorder::Scope;

}  // namespace adit::engine
