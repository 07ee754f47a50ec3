// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/device.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "adit/engine/context.hpp"
#include "adit/engine/vulkan/device_choice.hpp"

namespace adit::engine {

Device::Device(const ContextOptions& options)
    : instance(make_instance(options.validation, options.synchronization_validation)),
      profile(options.profile) {
  std::vector<vk::raii::PhysicalDevice> devices = enumerate_devices(instance);
  std::vector<DeviceInfo> infos;
  for (const vk::raii::PhysicalDevice& each : devices) {
    infos.push_back(describe(each, static_cast<uint32_t>(infos.size())));
  }
  const DeviceChoice choice = choose_device(infos, options.device);
  software_fallback = choice.software_fallback;
  physical = std::move(devices[choice.position]);
  info = std::move(infos[choice.position]);
  translated("opening device '" + info.name + "'", [&] { create_device(); });
  memory.emplace(physical, device, info.unified_memory, options.memory_budget_bytes);
}

void Device::create_device() {
  family = compute_family(physical).value();
  const auto properties =
      physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceVulkan11Properties,
                              vk::PhysicalDeviceVulkan13Properties>();
  max_buffer_bytes =
      std::min(properties.get<vk::PhysicalDeviceVulkan13Properties>().maxBufferSize,
               properties.get<vk::PhysicalDeviceVulkan11Properties>().maxMemoryAllocationSize);
  ns_per_tick = static_cast<double>(
      properties.get<vk::PhysicalDeviceProperties2>().properties.limits.timestampPeriod);
  const uint32_t tick_bits = physical.getQueueFamilyProperties()[family].timestampValidBits;
  tick_mask = std::numeric_limits<uint64_t>::max() >> (64U - tick_bits);

  const float priority = 1.0F;
  const vk::DeviceQueueCreateInfo queue_info({}, family, 1, &priority);
  vk::PhysicalDeviceVulkan12Features vulkan12;
  vulkan12.timelineSemaphore = VK_TRUE;
  vulkan12.scalarBlockLayout = VK_TRUE;
  vk::PhysicalDeviceVulkan13Features vulkan13;
  vulkan13.synchronization2 = VK_TRUE;
  vulkan13.maintenance4 = VK_TRUE;  // for work-group sizes given by specialization constants
  const vk::StructureChain chain(vk::DeviceCreateInfo({}, queue_info), vulkan12, vulkan13);
  device = vk::raii::Device(physical, chain.get<vk::DeviceCreateInfo>());
  queue = vk::raii::Queue(device, family, 0);
  pipeline_cache = vk::raii::PipelineCache(device, vk::PipelineCacheCreateInfo());
  const vk::StructureChain semaphore(vk::SemaphoreCreateInfo(),
                                     vk::SemaphoreTypeCreateInfo(vk::SemaphoreType::eTimeline, 0));
  timeline = vk::raii::Semaphore(device, semaphore.get<vk::SemaphoreCreateInfo>());
}

std::unique_ptr<CommandSlot> Device::begin_commands() {
  std::unique_ptr<CommandSlot> slot;
  {
    const std::scoped_lock lock(slots_mutex_);
    if (!free_slots_.empty()) {
      slot = std::move(free_slots_.back());
      free_slots_.pop_back();
    }
  }
  return translated("starting a recording", [&] {
    if (slot == nullptr) {
      slot = std::make_unique<CommandSlot>(device, family);
    }
    slot->begin();
    return std::move(slot);
  });
}

void Device::recycle(std::unique_ptr<CommandSlot> slot) {
  slot->release();
  const std::scoped_lock lock(slots_mutex_);
  free_slots_.push_back(std::move(slot));
}

uint64_t Device::submit(const CommandSlot& slot) {
  const vk::CommandBufferSubmitInfo commands(slot.handle());
  const std::scoped_lock lock(queue_mutex_);
  const uint64_t value = last_value_ + 1;
  const vk::SemaphoreSubmitInfo signal(*timeline, value, vk::PipelineStageFlagBits2::eAllCommands);
  translated("submitting work", [&] { queue.submit2(vk::SubmitInfo2({}, {}, commands, signal)); });
  last_value_ = value;
  return value;
}

void Device::wait(uint64_t value) const {
  const vk::SemaphoreWaitInfo info_wait({}, *timeline, value);
  translated("waiting for the device", [&] {
    while (device.waitSemaphores(info_wait, std::numeric_limits<uint64_t>::max()) ==
           vk::Result::eTimeout) {
    }
  });
}

bool Device::reached(uint64_t value) const {
  return translated("asking for the device's progress",
                    [&] { return timeline.getCounterValue() >= value; });
}

}  // namespace adit::engine
