// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "adit/engine/vulkan/device.hpp"

namespace adit::engine {

struct Buffer::State {
  State(Device& owner, uint64_t size, Memory where, std::string_view label);
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  Device* device;
  uint64_t bytes;
  Memory kind;
  std::string name;
  vk::raii::Buffer handle{nullptr};
  Allocator::Allocation memory;
  std::byte* mapped = nullptr;

  /// A view of a range, bytes, as texels of four 32-bit words. Kept for the next time, so that in
  /// the steady state none is made; whoever records it holds it until the device is done. From any
  /// thread.
  TexelView texels(uint64_t offset, uint64_t length) const;

 private:
  mutable std::mutex views_mutex_;
  mutable std::map<std::pair<uint64_t, uint64_t>, TexelView> views_;
};

}  // namespace adit::engine
