// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/command_slot.hpp"

#include <array>

namespace adit::engine {
namespace {

constexpr uint32_t kSetsPerPool = 128;
constexpr uint32_t kDescriptorsPerPool = 1024;
constexpr uint32_t kScopesPerPool = 128;

}  // namespace

CommandSlot::CommandSlot(const vk::raii::Device& device, uint32_t family)
    : device_(&device),
      pool_(device, vk::CommandPoolCreateInfo(vk::CommandPoolCreateFlagBits::eTransient, family)) {
  vk::raii::CommandBuffers buffers(device, {*pool_, vk::CommandBufferLevel::ePrimary, 1});
  commands_ = std::move(buffers.front());
}

void CommandSlot::begin() {
  pool_.reset();
  for (DescriptorPool& pool : descriptor_pools_) {
    pool.pool.reset();
    pool.sets_left = kSetsPerPool;
    pool.descriptors_left = kDescriptorsPerPool;
  }
  current_pool_ = 0;
  scopes_.clear();
  depth_ = 0;
  commands_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
}

void CommandSlot::end() {
  commands_.end();
}

vk::DescriptorSet CommandSlot::descriptor_set(vk::DescriptorSetLayout layout, uint32_t count) {
  while (current_pool_ < descriptor_pools_.size() &&
         (descriptor_pools_[current_pool_].sets_left == 0 ||
          descriptor_pools_[current_pool_].descriptors_left < count)) {
    ++current_pool_;
  }
  if (current_pool_ == descriptor_pools_.size()) {
    const std::array sizes = {
        vk::DescriptorPoolSize(vk::DescriptorType::eStorageBuffer, kDescriptorsPerPool),
        vk::DescriptorPoolSize(vk::DescriptorType::eUniformTexelBuffer, kDescriptorsPerPool)};
    descriptor_pools_.push_back({vk::raii::DescriptorPool(*device_, {{}, kSetsPerPool, sizes}),
                                 kSetsPerPool, kDescriptorsPerPool});
  }
  DescriptorPool& pool = descriptor_pools_[current_pool_];
  --pool.sets_left;
  pool.descriptors_left -= count;
  // The plain handle: sets are freed with their pool, never one by one.
  const VkDescriptorSetLayout c_layout = layout;
  const VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO, nullptr,
                                         *pool.pool, 1, &c_layout};
  VkDescriptorSet set = VK_NULL_HANDLE;
  const auto result = static_cast<vk::Result>(device_->getDispatcher()->vkAllocateDescriptorSets(
      static_cast<VkDevice>(**device_), &info, &set));
  if (result != vk::Result::eSuccess) {
    throw Error("allocating a descriptor set: " + vk::to_string(result));
  }
  return set;
}

uint32_t CommandSlot::open_scope(std::string_view name) {
  const auto index = static_cast<uint32_t>(scopes_.size());
  if (index / kScopesPerPool == query_pools_.size()) {
    query_pools_.emplace_back(
        *device_, vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, 2 * kScopesPerPool));
  }
  if (index % kScopesPerPool == 0) {
    commands_.resetQueryPool(*query_pools_[index / kScopesPerPool], 0, 2 * kScopesPerPool);
  }
  scopes_.push_back({name, depth_});
  ++depth_;
  timestamp(2 * index);
  return index;
}

void CommandSlot::close_scope(uint32_t index) {
  --depth_;
  timestamp(2 * index + 1);
}

// Taken when everything recorded before it is done: the time between two of them is that of the
// work between.
void CommandSlot::timestamp(uint32_t query) {
  commands_.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands,
                            *query_pools_[query / (2 * kScopesPerPool)],
                            query % (2 * kScopesPerPool));
}

std::vector<ScopeTime> CommandSlot::scope_times(double ns_per_tick, uint64_t tick_mask) const {
  std::vector<ScopeTime> times;
  for (std::size_t i = 0; i < scopes_.size(); ++i) {
    const auto [result, ticks] = query_pools_[i / kScopesPerPool].getResults<uint64_t>(
        static_cast<uint32_t>(2 * (i % kScopesPerPool)), 2, 2 * sizeof(uint64_t), sizeof(uint64_t),
        vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    if (result != vk::Result::eSuccess) {
      throw Error("reading timestamps: " + vk::to_string(result));
    }
    const uint64_t elapsed =
        (ticks[1] - ticks[0]) & tick_mask;  // right across a wrap of the counter
    times.push_back({std::string(scopes_[i].name),
                     static_cast<double>(elapsed) * ns_per_tick * 1e-6, scopes_[i].depth});
  }
  return times;
}

}  // namespace adit::engine
