// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/allocator.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <string>

namespace adit::engine {
namespace {

constexpr uint64_t kSmallestBlock = 4ULL << 20U;
constexpr uint64_t kLargestBlock = 64ULL << 20U;

using Property = vk::MemoryPropertyFlagBits;

struct Preference {
  vk::MemoryPropertyFlags needed;
  vk::MemoryPropertyFlags wanted;
  vk::MemoryPropertyFlags unwanted;
};

Preference preference(Memory kind, bool unified) {
  const vk::MemoryPropertyFlags mapped = Property::eHostVisible | Property::eHostCoherent;
  if (unified && kind == Memory::device) {
    return {mapped, Property::eDeviceLocal | Property::eHostCached, {}};
  }
  switch (kind) {
    case Memory::device:
      return {Property::eDeviceLocal, {}, Property::eHostVisible};
    case Memory::upload:
      // The window through which the host reaches a discrete GPU's own memory can be small.
      return {mapped, {}, Property::eDeviceLocal | Property::eHostCached};
    case Memory::readback:
      return {mapped, Property::eHostCached, Property::eDeviceLocal};
  }
  return {};
}

int bits(vk::MemoryPropertyFlags flags) {
  return std::popcount(static_cast<VkMemoryPropertyFlags>(flags));
}

uint64_t round_up(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

}  // namespace

Allocator::Allocator(const vk::raii::PhysicalDevice& physical, const vk::raii::Device& device,
                     bool unified, uint64_t budget)
    : device_(device),
      properties_(physical.getMemoryProperties()),
      unified_(unified),
      budget_(budget) {}

Allocator::Allocation Allocator::allocate(const vk::MemoryRequirements& requirements, Memory kind,
                                          std::string_view name) {
  const std::scoped_lock lock(mutex_);
  // Every position is a multiple of kSliceAlignment, which is enough for any buffer of a baseline
  // device.
  const uint64_t bytes =
      round_up(requirements.size, std::max<uint64_t>(kSliceAlignment, requirements.alignment));
  const uint32_t type = memory_type(requirements.memoryTypeBits, kind);
  const auto finish = [&](Block& block, uint64_t offset) {
    in_use_ += bytes;
    peak_ = std::max(peak_, in_use_);
    return Allocation{&block, offset, bytes};
  };
  uint64_t reserved_of_type = 0;
  for (Block& block : blocks_) {
    if (block.type != type) {
      continue;
    }
    reserved_of_type += block.free.size();
    if (const std::optional<uint64_t> offset = block.free.take(bytes)) {
      return finish(block, *offset);
    }
  }

  const uint64_t shared =
      std::clamp(std::bit_ceil(reserved_of_type), kSmallestBlock, kLargestBlock);
  Block* block = bytes <= shared / 2 ? new_block(type, shared) : nullptr;
  if (block == nullptr) {
    block = new_block(type, bytes);
  }
  if (block == nullptr) {
    for (uint32_t other = 0; other < properties_.memoryTypeCount; ++other) {
      release_unused(other, 0);
    }
    block = new_block(type, bytes);
  }
  if (block == nullptr) {
    throw OutOfMemory(
        "buffer '" + std::string(name) + "' of " + std::to_string(bytes) +
        " bytes does not fit: " + std::to_string(in_use_) + " bytes are in use by buffers, " +
        std::to_string(reserved_) + " are taken from the device, " +
        (within_budget(bytes) ? std::string("the device has no more to give")
                              : "the budget is " + std::to_string(budget_) + ", where at least " +
                                    std::to_string(reserved_ + bytes) + " are needed"));
  }
  return finish(*block, block->free.take(bytes).value());
}

void Allocator::free(const Allocation& allocation) {
  const std::scoped_lock lock(mutex_);
  allocation.block->free.give(allocation.offset, allocation.bytes);
  in_use_ -= allocation.bytes;
  release_unused(allocation.block->type, 1);
}

uint64_t Allocator::in_use() const {
  const std::scoped_lock lock(mutex_);
  return in_use_;
}

uint64_t Allocator::peak() const {
  const std::scoped_lock lock(mutex_);
  return peak_;
}

uint64_t Allocator::reserved() const {
  const std::scoped_lock lock(mutex_);
  return reserved_;
}

uint32_t Allocator::memory_type(uint32_t allowed, Memory kind) const {
  const Preference preferred = preference(kind, unified_);
  std::optional<uint32_t> best;
  int best_score = 0;
  for (uint32_t i = 0; i < properties_.memoryTypeCount; ++i) {
    const vk::MemoryPropertyFlags flags = properties_.memoryTypes[i].propertyFlags;
    if ((allowed >> i & 1U) == 0 || (flags & preferred.needed) != preferred.needed) {
      continue;
    }
    const int score = bits(flags & preferred.wanted) - bits(flags & preferred.unwanted);
    if (!best.has_value() || score > best_score) {
      best = i;
      best_score = score;
    }
  }
  if (!best.has_value()) {
    throw Error(
        "the device has no memory of the kind a buffer needs");  // against the specification
  }
  return *best;
}

// Null where the budget or the device has no room.
Allocator::Block* Allocator::new_block(uint32_t type, uint64_t bytes) {
  if (!within_budget(bytes)) {
    return nullptr;
  }
  Block block{.free = FreeList(bytes)};
  block.type = type;
  try {
    block.memory = vk::raii::DeviceMemory(device_, vk::MemoryAllocateInfo(bytes, type));
    if (properties_.memoryTypes[type].propertyFlags & Property::eHostVisible) {
      block.mapped = static_cast<std::byte*>(block.memory.mapMemory(0, VK_WHOLE_SIZE));
    }
  } catch (const vk::OutOfDeviceMemoryError&) {
    return nullptr;
  } catch (const vk::OutOfHostMemoryError&) {
    return nullptr;
  } catch (const vk::SystemError& error) {
    throw Error("taking " + std::to_string(bytes) + " bytes of device memory: " + error.what());
  }
  reserved_ += bytes;
  blocks_.push_back(std::move(block));
  return &blocks_.back();
}

// Gives unused blocks of a type back to the device, all but the first `keep` that are not larger
// than a shared block.
void Allocator::release_unused(uint32_t type, std::size_t keep) {
  std::erase_if(blocks_, [&](const Block& block) {
    if (block.type != type || !block.free.unused()) {
      return false;
    }
    if (keep > 0 && block.free.size() <= kLargestBlock) {
      --keep;
      return false;
    }
    reserved_ -= block.free.size();
    return true;
  });
}

}  // namespace adit::engine
