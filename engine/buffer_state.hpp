// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "engine/device.hpp"

namespace adit::engine {

struct Buffer::State {
  State(Device& owner, uint64_t size, Memory kind, std::string_view label);
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  Device* device;
  uint64_t bytes;
  std::string name;
  vk::raii::Buffer handle{nullptr};
  Allocator::Allocation memory;
  std::byte* mapped = nullptr;
};

}  // namespace adit::engine
