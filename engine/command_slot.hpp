// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/submission.hpp"
#include "engine/vulkan.hpp"

namespace adit::engine {

/// One command buffer with the descriptor sets and timestamps it needs: recorded, submitted, and
/// recycled whole once the device is done with it, so that in the steady state nothing is
/// allocated.
class CommandSlot {
 public:
  CommandSlot(const vk::raii::Device& device, uint32_t family);

  void begin();  ///< forgets what was recorded before
  void end();

  /// A set for `count` storage buffers; good until the next begin().
  vk::DescriptorSet descriptor_set(vk::DescriptorSetLayout layout, uint32_t count);

  /// Scopes are numbered in order of opening; each takes two timestamps.
  uint32_t open_scope(std::string_view name);
  void close_scope(uint32_t index);
  bool scopes_open() const { return depth_ > 0; }
  /// Reads the timestamps; only once the device is done.
  std::vector<ScopeTime> scope_times(double ns_per_tick, uint64_t tick_mask) const;

  const vk::raii::CommandBuffer& commands() const { return commands_; }
  vk::CommandBuffer handle() const { return *commands_; }

 private:
  struct DescriptorPool {
    vk::raii::DescriptorPool pool{nullptr};
    uint32_t sets_left = 0;
    uint32_t descriptors_left = 0;
  };
  struct OpenScope {
    std::string_view name;
    uint32_t depth;
  };
  void timestamp(uint32_t query);

  const vk::raii::Device* device_;
  vk::raii::CommandPool pool_{nullptr};
  vk::raii::CommandBuffer commands_{nullptr};
  std::vector<DescriptorPool> descriptor_pools_;
  std::size_t current_pool_ = 0;
  std::vector<vk::raii::QueryPool> query_pools_;
  std::vector<OpenScope> scopes_;
  uint32_t depth_ = 0;
};

}  // namespace adit::engine
