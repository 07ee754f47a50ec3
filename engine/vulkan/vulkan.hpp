// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Vulkan's C++ bindings, and the boundary where their exceptions become ours. For engine/*.cpp
// alone.
#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan_raii.hpp>

#include <string>
#include <utility>

#include "adit/engine/error.hpp"

namespace adit::engine {

/// Runs `call`; a failure in Vulkan becomes the engine's error "<what>: <function>: <VkResult>".
template <class Call>
auto translated(const std::string& what, Call&& call) -> decltype(call()) {
  try {
    return std::forward<Call>(call)();
  } catch (const vk::DeviceLostError& error) {
    throw DeviceLost(
        what + ": the device was lost (" + error.what() +
        "). A reset of the driver or a hang does this; start again, and if it comes back "
        "try another device");
  } catch (const vk::OutOfDeviceMemoryError& error) {
    throw OutOfMemory(what + ": " + error.what());
  } catch (const vk::OutOfHostMemoryError& error) {
    throw OutOfMemory(what + ": " + error.what());
  } catch (const vk::SystemError& error) {
    throw Error(what + ": " + error.what());
  }
}

}  // namespace adit::engine
