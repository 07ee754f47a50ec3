// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/engine/submission.hpp"
#include "adit/engine/vulkan/vulkan.hpp"

namespace adit::engine {

/// A view of a buffer as texels, shared by the buffer's cache and the recordings that use it.
using TexelView = std::shared_ptr<const vk::raii::BufferView>;
inline constexpr vk::Format kTexelFormat = vk::Format::eR32G32B32A32Uint;

/// One command buffer with the descriptor sets and timestamps it needs: recorded, submitted, and
/// recycled whole once the device is done with it, so that in the steady state nothing is
/// allocated.
class CommandSlot {
 public:
  CommandSlot(const vk::raii::Device& device, uint32_t family);

  void begin();  ///< forgets what was recorded before
  void end();

  /// A set for `count` buffers of either kind; good until the next begin().
  vk::DescriptorSet descriptor_set(vk::DescriptorSetLayout layout, uint32_t count);

  /// Holds a view that the recording uses until release().
  void keep(TexelView view) { views_.push_back(std::move(view)); }
  /// Lets go of what was kept; once the device is done, or where nothing was submitted.
  void release() { views_.clear(); }

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
  std::vector<TexelView> views_;
  std::vector<vk::raii::QueryPool> query_pools_;
  std::vector<OpenScope> scopes_;
  uint32_t depth_ = 0;
};

}  // namespace adit::engine
