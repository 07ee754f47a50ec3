// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/loader.hpp"

#include <cstdint>
#include <exception>

#include <vulkan/vulkan_raii.hpp>

namespace adit::engine {

std::optional<std::string> loader_version() {
  try {
    const vk::raii::Context loader;
    const uint32_t version = loader.enumerateInstanceVersion();
    return std::to_string(VK_API_VERSION_MAJOR(version)) + "." +
           std::to_string(VK_API_VERSION_MINOR(version)) + "." +
           std::to_string(VK_API_VERSION_PATCH(version));
  } catch (const std::exception&) {
    return std::nullopt;  // there is no libvulkan.so.1
  }
}

}  // namespace adit::engine
