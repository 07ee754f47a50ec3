// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/device.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "adit/engine/context.hpp"
#include "adit/engine/vulkan/device_choice.hpp"
#include "adit/engine/vulkan/process.hpp"

namespace adit::engine {

namespace {

// Whether the driver wrote these bytes, by the header that Vulkan gives every cache.
bool is_cache_of(const vk::raii::PhysicalDevice& device, std::span<const std::byte> bytes) {
  vk::PipelineCacheHeaderVersionOne header;
  if (bytes.size() < sizeof(header)) {
    return false;
  }
  std::memcpy(&header, bytes.data(), sizeof(header));
  const vk::PhysicalDeviceProperties properties = device.getProperties();
  return header.headerSize == sizeof(header) &&
         header.headerVersion == vk::PipelineCacheHeaderVersion::eOne &&
         header.vendorID == properties.vendorID && header.deviceID == properties.deviceID &&
         header.pipelineCacheUUID == properties.pipelineCacheUUID;
}

// Sums of wide kernels hold fewer than 2^24 points of 16 bytes (InputCell in
// shaders/shared/preprocess.h).
constexpr uint64_t kMostWideBytes = 16ULL * ((1U << 24U) - 1);

bool has_wide_words(const vk::raii::PhysicalDevice& device) {
  const auto features =
      device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>();
  return features.get<vk::PhysicalDeviceFeatures2>().features.shaderInt64 == VK_TRUE &&
         features.get<vk::PhysicalDeviceVulkan12Features>().shaderBufferInt64Atomics == VK_TRUE;
}

}  // namespace

Device::Device(const ContextOptions& options)
    : instance(make_instance(options.validation, options.synchronization_validation)),
      profile(options.profile),
      compile_only(options.compile_only) {
  std::vector<vk::raii::PhysicalDevice> devices = enumerate_devices(instance);
  std::vector<DeviceInfo> infos;
  for (const vk::raii::PhysicalDevice& each : devices) {
    infos.push_back(describe(each, static_cast<uint32_t>(infos.size())));
  }
  const DeviceChoice choice = choose_device(infos, options.device);
  software_fallback = choice.software_fallback;
  physical = std::move(devices[choice.position]);
  info = std::move(infos[choice.position]);
  info.gpu_shapes = !info.software || options.gpu_shapes;
  translated("opening device '" + info.name + "'", [&] { create_device(); });
  keep_drivers_loaded();  // and what they have loaded for it
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
  vk::PhysicalDeviceFeatures core;
  wide = !info.gpu_shapes && info.max_storage_buffer_bytes <= kMostWideBytes &&
         has_wide_words(physical);
  if (wide) {
    core.shaderInt64 = VK_TRUE;
    vulkan12.shaderBufferInt64Atomics = VK_TRUE;
  }
  vk::PhysicalDeviceVulkan13Features vulkan13;
  vulkan13.synchronization2 = VK_TRUE;
  vulkan13.maintenance4 = VK_TRUE;  // for work-group sizes given by specialization constants
  vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR executables(VK_TRUE);
  vk::StructureChain chain(vk::DeviceCreateInfo({}, queue_info, {}, {}, &core), vulkan12, vulkan13,
                           executables);
  const std::array extensions = {VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME};
  if (compile_only) {
    const auto offered = physical.enumerateDeviceExtensionProperties();
    if (std::ranges::none_of(offered, [&](const vk::ExtensionProperties& one) {
          return std::string_view(one.extensionName.data()) == extensions.front();
        })) {
      throw Error("the driver of '" + info.name +
                  "' tells nothing of the kernels that it compiles: " + extensions.front() +
                  " is missing");
    }
    chain.get<vk::DeviceCreateInfo>().setPEnabledExtensionNames(extensions);
  } else {
    chain.unlink<vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR>();
  }
  device = vk::raii::Device(physical, chain.get<vk::DeviceCreateInfo>());
  queue = vk::raii::Queue(device, family, 0);
  pipeline_cache = vk::raii::PipelineCache(device, vk::PipelineCacheCreateInfo());
  if (compile_only) {
    return;  // a compiler without its device has no semaphores
  }
  const vk::StructureChain semaphore(vk::SemaphoreCreateInfo(),
                                     vk::SemaphoreTypeCreateInfo(vk::SemaphoreType::eTimeline, 0));
  timeline = vk::raii::Semaphore(device, semaphore.get<vk::SemaphoreCreateInfo>());
}

void Device::add_to_pipeline_cache(std::span<const std::byte> earlier) {
  if (!is_cache_of(physical, earlier)) {
    return;
  }
  try {
    const vk::raii::PipelineCache piece(
        device, vk::PipelineCacheCreateInfo({}, earlier.size(), earlier.data()));
    pipeline_cache.merge(*piece);
  } catch (const vk::SystemError&) {
    // A driver may refuse what it wrote; then it compiles again.
  }
}

std::vector<std::byte> Device::pipeline_cache_data() const {
  return translated("reading the pipeline cache", [&] {
    const std::vector<uint8_t> bytes = pipeline_cache.getData();
    if (bytes.size() <= sizeof(vk::PipelineCacheHeaderVersionOne)) {
      return std::vector<std::byte>();
    }
    const std::span<const std::byte> view = std::as_bytes(std::span(bytes));
    return std::vector<std::byte>(view.begin(), view.end());
  });
}

vk::PipelineCreateFlags Device::pipeline_flags() const {
  return compile_only ? vk::PipelineCreateFlagBits::eCaptureStatisticsKHR
                      : vk::PipelineCreateFlags();
}

void Device::note_statistics(vk::Pipeline pipeline, KernelStatistics kernel) {
  for (const vk::PipelineExecutableStatisticKHR& statistic :
       device.getPipelineExecutableStatisticsKHR({pipeline, 0})) {
    using Format = vk::PipelineExecutableStatisticFormatKHR;
    const vk::PipelineExecutableStatisticValueKHR& value = statistic.value;
    const double number = statistic.format == Format::eUint64    ? static_cast<double>(value.u64)
                          : statistic.format == Format::eInt64   ? static_cast<double>(value.i64)
                          : statistic.format == Format::eFloat64 ? value.f64
                                                                 : (value.b32 != 0 ? 1.0 : 0.0);
    kernel.values.emplace_back(statistic.name.data(), number);
  }
  const std::scoped_lock lock(statistics_mutex);
  statistics.push_back(std::move(kernel));
}

std::unique_ptr<CommandSlot> Device::begin_commands() {
  require_device_process();
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
  require_device_process();
  const vk::CommandBufferSubmitInfo commands(slot.handle());
  const std::scoped_lock lock(queue_mutex_);
  const uint64_t value = last_value_ + 1;
  const vk::SemaphoreSubmitInfo signal(*timeline, value, vk::PipelineStageFlagBits2::eAllCommands);
  translated("submitting work", [&] { queue.submit2(vk::SubmitInfo2({}, {}, commands, signal)); });
  last_value_ = value;
  return value;
}

// One thread waits in the driver, for whatever ends next, and tells the others. Where two of them
// wait, NVIDIA's wakes one, and the other after 10 ms.
void Device::wait(uint64_t value) const {
  require_device_process();
  std::unique_lock lock(wait_mutex_);
  while (true) {
    const uint64_t ended =
        translated("waiting for the device", [&] { return timeline.getCounterValue(); });
    if (ended >= value) {
      return;
    }
    if (waiting_) {
      woken_.wait(lock);
      continue;
    }
    waiting_ = true;
    lock.unlock();
    const auto done = [&] {
      lock.lock();
      waiting_ = false;
      woken_.notify_all();
    };
    try {
      const uint64_t next = ended + 1;
      const vk::SemaphoreWaitInfo info_wait({}, *timeline, next);
      translated("waiting for the device", [&] {
        while (device.waitSemaphores(info_wait, std::numeric_limits<uint64_t>::max()) ==
               vk::Result::eTimeout) {
        }
      });
    } catch (...) {
      done();
      throw;
    }
    done();
  }
}

bool Device::reached(uint64_t value) const {
  require_device_process();
  return translated("asking for the device's progress",
                    [&] { return timeline.getCounterValue() >= value; });
}

}  // namespace adit::engine
