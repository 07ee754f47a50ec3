// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "adit/engine/device_info.hpp"
#include "adit/engine/vulkan/allocator.hpp"
#include "adit/engine/vulkan/command_slot.hpp"
#include "adit/engine/vulkan/instance.hpp"
#include "adit/engine/vulkan/vulkan.hpp"

namespace adit::engine {

struct ContextOptions;
struct KernelStatistics;

/// What a Context owns: the logical device, its queue and timeline, memory and recycled command
/// buffers. Members are destroyed in reverse order. Stays in one place: buffers and kernels point
/// to it.
struct Device {
  explicit Device(const ContextOptions& options);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// A command buffer that is being recorded, new or used before.
  std::unique_ptr<CommandSlot> begin_commands();
  void recycle(std::unique_ptr<CommandSlot> slot);
  /// Puts recorded commands on the queue; the timeline reaches the returned value when they are
  /// done.
  uint64_t submit(const CommandSlot& slot);
  void wait(uint64_t value) const;
  /// Empty where the driver keeps nothing in it.
  std::vector<std::byte> pipeline_cache_data() const;
  void add_to_pipeline_cache(std::span<const std::byte> earlier);
  /// Adds what the driver tells of a pipeline that was made with this device's pipeline_flags().
  void note_statistics(vk::Pipeline pipeline, KernelStatistics kernel);
  vk::PipelineCreateFlags pipeline_flags() const;
  bool reached(uint64_t value) const;

  template <class Object>
  void set_name(const Object& object, std::string_view name) const {
    if (instance.debug_names) {
      using Handle = typename Object::CType;
      const std::string text(name);
      device.setDebugUtilsObjectNameEXT({Object::objectType,
                                         reinterpret_cast<uint64_t>(static_cast<Handle>(*object)),
                                         text.c_str()});
    }
  }

  Instance instance;
  bool profile = false;
  bool compile_only = false;
  bool software_fallback = false;
  /// Kernels that have it add, read and write 64 bits at once (shaders/include/wide.glsl).
  bool wide = false;
  vk::raii::PhysicalDevice physical{nullptr};
  DeviceInfo info;
  uint64_t max_buffer_bytes = 0;
  double ns_per_tick = 1.0;
  uint64_t tick_mask = 0;  ///< the bits of a timestamp that count
  vk::raii::Device device{nullptr};
  vk::raii::Queue queue{nullptr};
  uint32_t family = 0;
  vk::raii::PipelineCache pipeline_cache{nullptr};
  vk::raii::Semaphore timeline{nullptr};
  std::optional<Allocator> memory;
  std::mutex statistics_mutex;
  std::vector<KernelStatistics> statistics;

 private:
  void create_device();

  mutable std::mutex wait_mutex_;
  mutable std::condition_variable woken_;
  mutable bool waiting_ = false;  // a thread waits in the driver
  std::mutex queue_mutex_;
  uint64_t last_value_ = 0;
  std::mutex slots_mutex_;
  std::vector<std::unique_ptr<CommandSlot>> free_slots_;
};

}  // namespace adit::engine
