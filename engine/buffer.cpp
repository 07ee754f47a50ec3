// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/buffer.hpp"

#include <memory>
#include <stdexcept>

#include "adit/engine/vulkan/buffer_state.hpp"
#include "adit/engine/vulkan/process.hpp"

namespace adit::engine {
namespace {

// Far more than the ranges of a buffer that kernels bind again and again.
constexpr std::size_t kMaxViews = 64;

}  // namespace

Buffer::State::State(Device& owner, uint64_t size, Memory where, std::string_view label)
    : device(&owner), bytes(size), kind(where), name(label) {
  if (bytes == 0) {
    throw std::invalid_argument("buffer '" + name + "': 0 bytes asked for");
  }
  if (bytes > owner.max_buffer_bytes) {
    throw OutOfMemory("buffer '" + name + "' of " + std::to_string(bytes) +
                      " bytes: the largest buffer of " + owner.info.name + " has " +
                      std::to_string(owner.max_buffer_bytes) + " bytes (budget " +
                      std::to_string(owner.memory->budget()) + ", in use " +
                      std::to_string(owner.memory->in_use()) + ")");
  }
  translated("making buffer '" + name + "' of " + std::to_string(bytes) + " bytes", [&] {
    using Usage = vk::BufferUsageFlagBits;
    handle = vk::raii::Buffer(
        owner.device,
        vk::BufferCreateInfo({}, bytes,
                             Usage::eStorageBuffer | Usage::eTransferSrc | Usage::eTransferDst |
                                 Usage::eIndirectBuffer | Usage::eUniformTexelBuffer));
    owner.set_name(handle, name);
    memory = owner.memory->allocate(handle.getMemoryRequirements(), kind, name);
    try {
      handle.bindMemory(*memory.block->memory, memory.offset);
    } catch (...) {
      owner.memory->free(memory);
      throw;
    }
  });
  mapped = memory.block->mapped == nullptr ? nullptr : memory.block->mapped + memory.offset;
}

TexelView Buffer::State::texels(uint64_t offset, uint64_t length) const {
  const std::scoped_lock lock(views_mutex_);
  const auto found = views_.find({offset, length});
  if (found != views_.end()) {
    return found->second;
  }
  if (views_.size() == kMaxViews) {
    views_.clear();  // lengths that change from sweep to sweep; recordings hold what they use
  }
  const vk::BufferViewCreateInfo info({}, *handle, kTexelFormat, offset, length);
  auto view = translated("viewing buffer '" + name + "' as texels", [&] {
    return std::make_shared<const vk::raii::BufferView>(device->device, info);
  });
  device->set_name(*view, name);
  views_.emplace(std::pair{offset, length}, view);
  return view;
}

Buffer::State::~State() {
  views_.clear();
  handle = vk::raii::Buffer(nullptr);
  device->memory->free(memory);
}

Buffer::Buffer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Buffer::Buffer(Buffer&&) noexcept = default;
Buffer& Buffer::operator=(Buffer&&) noexcept = default;
Buffer::~Buffer() {
  leave_to_parent(state_);
}

uint64_t Buffer::size() const {
  return state_->bytes;
}
const std::string& Buffer::name() const {
  return state_->name;
}
std::byte* Buffer::mapped() const {
  require_device_process();  // drivers need not map their memory in a forked process
  return state_->mapped;
}

Slice Slice::sub(uint64_t at, uint64_t length) const {
  if (at > bytes || length > bytes - at) {
    throw std::out_of_range("a slice of " + std::to_string(length) + " bytes at " +
                            std::to_string(at) + " is not inside one of " + std::to_string(bytes) +
                            " bytes" +
                            (buffer == nullptr ? "" : " of buffer '" + buffer->name + "'"));
  }
  return {buffer, offset + at, length};
}

Slice Slice::from(uint64_t at) const {
  return sub(at, at > bytes ? 0 : bytes - at);
}

std::byte* Slice::mapped() const {
  require_device_process();
  return buffer == nullptr || buffer->mapped == nullptr ? nullptr : buffer->mapped + offset;
}

}  // namespace adit::engine
