// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/device_info.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "adit/engine/buffer.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/engine/vulkan/command_slot.hpp"
#include "adit/engine/vulkan/instance.hpp"
#include "adit/engine/vulkan/spirv.hpp"

namespace adit::engine {
namespace {

std::string version(uint32_t packed) {
  return std::to_string(VK_API_VERSION_MAJOR(packed)) + "." +
         std::to_string(VK_API_VERSION_MINOR(packed)) + "." +
         std::to_string(VK_API_VERSION_PATCH(packed));
}

std::string uuid_text(const uint8_t* bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < VK_UUID_SIZE; ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) {
      text.push_back('-');
    }
    text.push_back(kDigits[bytes[i] >> 4U]);
    text.push_back(kDigits[bytes[i] & 15U]);
  }
  return text;
}

Requirement at_least(std::string name, uint64_t needed, uint64_t has) {
  return {std::move(name), ">= " + std::to_string(needed), std::to_string(has), has >= needed};
}

Requirement at_most(std::string name, uint64_t needed, uint64_t has) {
  return {std::move(name), "<= " + std::to_string(needed), std::to_string(has), has <= needed};
}

Requirement feature(std::string name, bool has) {
  return {std::move(name), "yes", has ? "yes" : "no", has};
}

// The baseline of docs/architecture.md: what every kernel may assume, and no more.
std::vector<Requirement> requirements(const vk::raii::PhysicalDevice& device) {
  const auto properties =
      device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceVulkan11Properties>();
  const vk::PhysicalDeviceProperties& core =
      properties.get<vk::PhysicalDeviceProperties2>().properties;
  const vk::PhysicalDeviceLimits& limits = core.limits;
  const auto& subgroups = properties.get<vk::PhysicalDeviceVulkan11Properties>();
  const auto features =
      device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features,
                          vk::PhysicalDeviceVulkan13Features>();
  const auto& vulkan12 = features.get<vk::PhysicalDeviceVulkan12Features>();
  const auto& vulkan13 = features.get<vk::PhysicalDeviceVulkan13Features>();

  std::vector<Requirement> list;
  list.push_back(
      {"apiVersion", ">= 1.3", version(core.apiVersion), core.apiVersion >= VK_API_VERSION_1_3});
  const std::optional<uint32_t> family = compute_family(device);
  list.push_back(feature("a queue that computes", family.has_value()));
  const uint32_t timestamp_bits =
      family.has_value() ? device.getQueueFamilyProperties()[*family].timestampValidBits : 0;
  list.push_back(at_least("timestampValidBits of that queue", 32, timestamp_bits));
  list.push_back(feature("timelineSemaphore", vulkan12.timelineSemaphore == VK_TRUE));
  list.push_back(feature("scalarBlockLayout", vulkan12.scalarBlockLayout == VK_TRUE));
  list.push_back(feature("synchronization2", vulkan13.synchronization2 == VK_TRUE));
  list.push_back(feature("maintenance4", vulkan13.maintenance4 == VK_TRUE));
  list.push_back(at_least("subgroupSize", 4, subgroups.subgroupSize));
  list.push_back(at_most("subgroupSize", 128, subgroups.subgroupSize));
  const bool in_compute =
      static_cast<bool>(subgroups.subgroupSupportedStages & vk::ShaderStageFlagBits::eCompute);
  using Subgroup = vk::SubgroupFeatureFlagBits;
  for (const Subgroup operation : {Subgroup::eBasic, Subgroup::eVote, Subgroup::eArithmetic,
                                   Subgroup::eBallot, Subgroup::eShuffle}) {
    list.push_back(feature("subgroup " + vk::to_string(operation) + " in compute shaders",
                           in_compute && (subgroups.subgroupSupportedOperations & operation)));
  }
  list.push_back(
      at_least("maxComputeWorkGroupInvocations", 256, limits.maxComputeWorkGroupInvocations));
  list.push_back(at_least("maxComputeWorkGroupSize[0]", 256, limits.maxComputeWorkGroupSize[0]));
  list.push_back(
      at_least("maxComputeWorkGroupCount[0]", kMaxGroups, limits.maxComputeWorkGroupCount[0]));
  list.push_back(
      at_least("maxComputeSharedMemorySize", 16 * 1024, limits.maxComputeSharedMemorySize));
  list.push_back(at_least("maxPushConstantsSize", 128, limits.maxPushConstantsSize));
  list.push_back(at_least("maxStorageBufferRange", 128ULL << 20U, limits.maxStorageBufferRange));
  list.push_back(at_least("maxPerStageDescriptorStorageBuffers", kMaxStorageBindings,
                          limits.maxPerStageDescriptorStorageBuffers));
  list.push_back(at_least("maxPerStageDescriptorSampledImages", kMaxTexelBindings,
                          limits.maxPerStageDescriptorSampledImages));
  list.push_back(feature("R32G32B32A32_UINT in uniform texel buffers",
                         static_cast<bool>(device.getFormatProperties(kTexelFormat).bufferFeatures &
                                           vk::FormatFeatureFlagBits::eUniformTexelBuffer)));
  list.push_back(at_least("maxTexelBufferElements", kMinTexels, limits.maxTexelBufferElements));
  list.push_back(at_most("minTexelBufferOffsetAlignment", kSliceAlignment,
                         limits.minTexelBufferOffsetAlignment));
  list.push_back(at_most("minStorageBufferOffsetAlignment", kSliceAlignment,
                         limits.minStorageBufferOffsetAlignment));
  return list;
}

bool unified(const vk::PhysicalDeviceMemoryProperties& memory, vk::PhysicalDeviceType type) {
  using Property = vk::MemoryPropertyFlagBits;
  const vk::MemoryPropertyFlags both =
      Property::eDeviceLocal | Property::eHostVisible | Property::eHostCoherent;
  // A discrete GPU with a large BAR shows such memory too, but the host reads it across the bus.
  return (type == vk::PhysicalDeviceType::eCpu || type == vk::PhysicalDeviceType::eIntegratedGpu) &&
         std::any_of(memory.memoryTypes.begin(),
                     memory.memoryTypes.begin() + memory.memoryTypeCount,
                     [&](const vk::MemoryType& t) { return (t.propertyFlags & both) == both; });
}

}  // namespace

bool DeviceInfo::meets_baseline() const {
  return std::ranges::all_of(requirements, &Requirement::met);
}

std::optional<uint32_t> compute_family(const vk::raii::PhysicalDevice& device) {
  const auto families = device.getQueueFamilyProperties();
  std::optional<uint32_t> first;
  for (uint32_t i = 0; i < families.size(); ++i) {
    if (families[i].queueFlags & vk::QueueFlagBits::eCompute) {
      if (families[i].timestampValidBits > 0) {
        return i;
      }
      first = first.value_or(i);
    }
  }
  return first;
}

DeviceInfo describe(const vk::raii::PhysicalDevice& device, uint32_t index) {
  const vk::PhysicalDeviceProperties core = device.getProperties();
  DeviceInfo info;
  info.index = index;
  info.name = core.deviceName.data();
  info.api_version = version(core.apiVersion);
  info.driver_version = version(core.driverVersion);
  info.software = core.deviceType == vk::PhysicalDeviceType::eCpu;
  info.max_storage_buffer_bytes = core.limits.maxStorageBufferRange;
  info.max_texel_buffer_elements = core.limits.maxTexelBufferElements;
  info.max_workgroup_invocations = core.limits.maxComputeWorkGroupInvocations;
  info.max_shared_bytes = core.limits.maxComputeSharedMemorySize;
  const vk::PhysicalDeviceMemoryProperties memory = device.getMemoryProperties();
  for (uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
    if (memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal) {
      info.device_memory_bytes += memory.memoryHeaps[i].size;
    }
  }
  info.unified_memory = unified(memory, core.deviceType);
  if (core.apiVersion < VK_API_VERSION_1_3) {
    // The structures read below came with Vulkan 1.3; asking an older driver for them says nothing.
    info.requirements = {{"apiVersion", ">= 1.3", info.api_version, false}};
    return info;
  }
  const auto properties =
      device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceVulkan11Properties,
                            vk::PhysicalDeviceVulkan12Properties>();
  const auto& vulkan11 = properties.get<vk::PhysicalDeviceVulkan11Properties>();
  const auto& vulkan12 = properties.get<vk::PhysicalDeviceVulkan12Properties>();
  info.subgroup_size = vulkan11.subgroupSize;
  info.uuid = uuid_text(vulkan11.deviceUUID.data());
  info.driver = vulkan12.driverName.data();
  if (vulkan12.driverInfo[0] != '\0') {
    info.driver_version = vulkan12.driverInfo.data();
  }
  info.requirements = requirements(device);
  return info;
}

}  // namespace adit::engine
