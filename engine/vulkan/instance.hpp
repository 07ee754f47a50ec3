// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "adit/engine/device_info.hpp"
#include "adit/engine/vulkan/vulkan.hpp"

namespace adit::engine {

/// What the validation layer said; its callback comes from any thread that calls Vulkan.
class MessageLog {
 public:
  void add(std::string message);
  std::vector<std::string> messages() const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
};

/// The Vulkan instance, with validation on request. Order matters: members are destroyed in
/// reverse.
struct Instance {
  std::unique_ptr<MessageLog> log;
  std::unique_ptr<vk::raii::Context> loader;
  vk::raii::Instance instance{nullptr};
  vk::raii::DebugUtilsMessengerEXT messenger{nullptr};
  bool debug_names = false;  ///< VK_EXT_debug_utils is there to name objects for messages
};

/// Throws Error: no loader, no driver, no validation layer where it is asked for.
Instance make_instance(bool validation, bool synchronization_validation);

/// Whatever is loaded now stays so for as long as the process lives.
void keep_drivers_loaded();

/// All physical devices, in the loader's order; at least one, or Error.
std::vector<vk::raii::PhysicalDevice> enumerate_devices(const Instance& instance);

/// What `device` is and has of the baseline.
DeviceInfo describe(const vk::raii::PhysicalDevice& device, uint32_t index);

/// The queue family that work goes to; empty where none computes.
std::optional<uint32_t> compute_family(const vk::raii::PhysicalDevice& device);

}  // namespace adit::engine
