// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/engine/kernel.hpp"
#include "adit/engine/vulkan/device.hpp"

namespace adit::engine {

struct Kernel::State {
  Device* device = nullptr;
  std::string name;
  Reflection reflection;
  uint32_t local_size = 0;
  vk::raii::DescriptorSetLayout set_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
};

}  // namespace adit::engine
