// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/engine/buffer.hpp"
#include "adit/engine/device_info.hpp"
#include "adit/engine/error.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/engine/submission.hpp"

namespace adit::engine {

struct Device;

/// How a device is chosen and used.
struct ContextOptions {
  /// Index, UUID, or part of the name or driver (case-insensitive). Empty: the first device that is
  /// not software; a software one only where there is nothing else.
  std::string device;
  bool validation = false;                  ///< load the validation layer and collect its messages
  bool synchronization_validation = false;  ///< also look for missing barriers (implies validation)
  bool profile = false;                     ///< measure Recorder::scope()
  uint64_t memory_budget_bytes = 0;         ///< 0: no limit but the device's
  /// Kernels are launched on a software device as on a GPU: so tests see those shapes without one.
  bool gpu_shapes = false;
  /// Nothing can run: for statistics of what a compiler makes of kernels, without its device.
  bool compile_only = false;
};

/// What a driver's compiler tells of a kernel that it made.
struct KernelStatistics {
  std::string kernel;                                  ///< its name
  std::vector<Specialization> specializations;         ///< as it was specialised
  std::vector<std::pair<std::string, double>> values;  ///< by the driver's names, in its order
};

/// A device, its memory and its queue; the one object of the engine that is passed around. It
/// outlives every buffer, kernel, recorder and submission made with it. Its functions may be called
/// from any thread. It does not survive fork(): in the child all work throws Error, also on a
/// Context of its own once the parent has had one.
class Context {
 public:
  /// Throws Error: no driver, no such device (listing what there is), a device below the baseline
  /// (listing what it lacks), no validation layer.
  explicit Context(const ContextOptions& options);
  Context(Context&&) noexcept;
  Context& operator=(Context&&) noexcept;
  ~Context();

  /// The device that it runs on.
  const DeviceInfo& device() const;
  /// Nothing was asked for and only software was found. The caller says so.
  bool software_fallback() const;

  /// `bytes` > 0. Throws OutOfMemory naming the buffer, its size, the budget and what is in use.
  Buffer make_buffer(uint64_t bytes, Memory kind, std::string_view name);

  uint64_t memory_in_use() const;  ///< bytes of the buffers alive, each rounded up to its alignment
  uint64_t memory_peak() const;    ///< the largest memory_in_use() so far
  uint64_t memory_reserved() const;  ///< bytes taken from the device; what the budget bounds

  /// A new command buffer. The context outlives it.
  Recorder make_recorder();
  /// Starts the work; submissions run in the order of these calls.
  Submission submit(Recorder&& recorder);

  /// What the driver would compile again without it, for add_to_pipeline_cache() of a later
  /// context; empty where it keeps nothing here (Mesa's software driver has a cache of its own).
  std::vector<std::byte> pipeline_cache() const;
  /// Kernels made after this are found there. What another device or driver wrote, and what is no
  /// pipeline cache, is passed over.
  void add_to_pipeline_cache(std::span<const std::byte> earlier);

  /// Of every kernel made so far; with ContextOptions::compile_only alone.
  std::vector<KernelStatistics> kernel_statistics() const;

  /// Warnings and errors of the validation layer so far; empty is what it should be.
  std::vector<std::string> validation_messages() const;

  Device& internal() const { return *device_; }  ///< for the engine alone

 private:
  std::unique_ptr<Device> device_;
};

}  // namespace adit::engine
