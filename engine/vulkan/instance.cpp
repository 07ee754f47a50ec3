// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/instance.hpp"

#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace adit::engine {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr const char* kInstallDriver =
    "Install the driver of your GPU, or a software one (Debian: apt install mesa-vulkan-drivers), "
    "and "
    "see what vulkaninfo --summary lists";

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT /*severity*/,
                                       VkDebugUtilsMessageTypeFlagsEXT /*types*/,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data,
                                       void* log) {
  static_cast<MessageLog*>(log)->add(data->pMessage);
  return VK_FALSE;
}

bool has_layer(const vk::raii::Context& loader, std::string_view name) {
  return std::ranges::any_of(loader.enumerateInstanceLayerProperties(),
                             [&](const auto& layer) { return name == layer.layerName.data(); });
}

std::unique_ptr<vk::raii::Context> open_loader() {
  try {
    return std::make_unique<vk::raii::Context>();
  } catch (const std::exception& error) {
    throw Error(std::string("the Vulkan loader, libvulkan.so.1, is not there (") + error.what() +
                "). Install it (Debian: apt install libvulkan1). " + kInstallDriver);
  }
}

int add_name(dl_phdr_info* library, std::size_t /*bytes*/, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(library->dlpi_name);
  return 0;
}

}  // namespace

// The loader unloads drivers with the last instance. NVIDIA's takes thread-local storage each time
// that it is loaded and does not give it back: after some ten times it is not found any more.
void keep_drivers_loaded() {
  std::vector<std::string> names;
  dl_iterate_phdr(&add_name, &names);
  for (const std::string& name : names) {
    void* library =
        name.empty() ? nullptr : dlopen(name.c_str(), RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE);
    if (library != nullptr) {
      dlclose(library);
    }
  }
}

void MessageLog::add(std::string message) {
  const std::scoped_lock lock(mutex_);
  messages_.push_back(std::move(message));
}

std::vector<std::string> MessageLog::messages() const {
  const std::scoped_lock lock(mutex_);
  return messages_;
}

Instance make_instance(bool validation, bool synchronization_validation) {
  Instance result;
  result.log = std::make_unique<MessageLog>();
  result.loader = open_loader();

  const vk::ApplicationInfo application("adit", 0, nullptr, 0, VK_API_VERSION_1_3);
  vk::InstanceCreateInfo info({}, &application);
  std::vector<const char*> layers;
  std::vector<const char*> extensions;
  const std::array enabled{vk::ValidationFeatureEnableEXT::eSynchronizationValidation};
  const vk::ValidationFeaturesEXT features(enabled);
  if (validation || synchronization_validation) {
    if (!has_layer(*result.loader, kValidationLayer)) {
      throw Error(std::string("validation was asked for, but the layer ") + kValidationLayer +
                  " is missing (Debian: apt install vulkan-validationlayers)");
    }
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (synchronization_validation) {
      extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
      info.pNext = &features;
    }
  }
  info.setPEnabledLayerNames(layers).setPEnabledExtensionNames(extensions);
  try {
    result.instance = vk::raii::Instance(*result.loader, info);
  } catch (const vk::IncompatibleDriverError&) {
    throw Error(std::string("no Vulkan driver was found. ") + kInstallDriver);
  } catch (const vk::SystemError& error) {
    throw Error(std::string("creating a Vulkan 1.3 instance: ") + error.what());
  }

  if (validation || synchronization_validation) {
    // The C struct: vulkan.hpp has had two types of callbacks, and calls the first deprecated.
    VkDebugUtilsMessengerCreateInfoEXT messenger{};
    messenger.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                                VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                            VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
    messenger.pfnUserCallback = &collect;
    messenger.pUserData = result.log.get();
    result.messenger = translated("creating the debug messenger", [&] {
      return vk::raii::DebugUtilsMessengerEXT(result.instance,
                                              vk::DebugUtilsMessengerCreateInfoEXT(messenger));
    });
    result.debug_names = true;
  }
  keep_drivers_loaded();
  return result;
}

std::vector<vk::raii::PhysicalDevice> enumerate_devices(const Instance& instance) {
  std::vector<vk::raii::PhysicalDevice> devices;
  try {
    for (vk::raii::PhysicalDevice& device : vk::raii::PhysicalDevices(instance.instance)) {
      devices.push_back(std::move(device));
    }
  } catch (const vk::SystemError& error) {
    throw Error(std::string("listing the Vulkan devices: ") + error.what() + ". " + kInstallDriver);
  }
  if (devices.empty()) {
    throw Error(std::string("there is no Vulkan device. ") + kInstallDriver);
  }
  return devices;
}

std::vector<DeviceInfo> list_devices() {
  const Instance instance = make_instance(false, false);
  std::vector<DeviceInfo> infos;
  for (const vk::raii::PhysicalDevice& device : enumerate_devices(instance)) {
    infos.push_back(describe(device, static_cast<uint32_t>(infos.size())));
  }
  return infos;
}

}  // namespace adit::engine
