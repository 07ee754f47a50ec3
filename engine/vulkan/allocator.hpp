// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <string_view>

#include "adit/engine/buffer.hpp"
#include "adit/engine/vulkan/free_list.hpp"
#include "adit/engine/vulkan/vulkan.hpp"

namespace adit::engine {

/// Device memory in blocks, cut into buffers. Blocks of a memory type grow from 4 to 64 MiB; what
/// does not fit into half a large block gets one of its own. An unused block is kept where it is
/// the only one of its type, so that a buffer made for every sweep costs no system call.
class Allocator {
 public:
  struct Block {
    vk::raii::DeviceMemory memory{nullptr};
    std::byte* mapped = nullptr;
    uint32_t type = 0;
    FreeList free;
  };
  struct Allocation {
    Block* block = nullptr;
    uint64_t offset = 0;
    uint64_t bytes = 0;  ///< rounded up to the alignment
  };

  /// `budget` bounds what is taken from the device, bytes; 0: no limit.
  Allocator(const vk::raii::PhysicalDevice& physical, const vk::raii::Device& device, bool unified,
            uint64_t budget);

  /// Throws OutOfMemory, naming `name`, the size, the budget and what is in use.
  Allocation allocate(const vk::MemoryRequirements& requirements, Memory kind,
                      std::string_view name);
  void free(const Allocation& allocation);

  uint64_t in_use() const;
  uint64_t peak() const;
  uint64_t reserved() const;
  uint64_t budget() const { return budget_; }

 private:
  uint32_t memory_type(uint32_t allowed, Memory kind) const;
  Block* new_block(uint32_t type, uint64_t bytes);
  void release_unused(uint32_t type, std::size_t keep);
  bool within_budget(uint64_t bytes) const { return budget_ == 0 || reserved_ + bytes <= budget_; }

  const vk::raii::Device& device_;
  const vk::PhysicalDeviceMemoryProperties properties_;
  const bool unified_;
  const uint64_t budget_;
  mutable std::mutex mutex_;
  std::list<Block> blocks_;
  uint64_t in_use_ = 0;
  uint64_t peak_ = 0;
  uint64_t reserved_ = 0;
};

}  // namespace adit::engine
