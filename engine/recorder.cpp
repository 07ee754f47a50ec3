// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/recorder.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "adit/engine/vulkan/buffer_state.hpp"
#include "adit/engine/vulkan/kernel_state.hpp"
#include "adit/engine/vulkan/process.hpp"
#include "adit/engine/vulkan/recorder_state.hpp"

namespace adit::engine {
namespace {

constexpr std::size_t kMaxBindings = kMaxStorageBindings + kMaxTexelBindings;
constexpr uint64_t kIndirectBytes = 3 * sizeof(uint32_t);

[[noreturn]] void mistake(const Kernel& kernel, const std::string& what) {
  throw std::logic_error("kernel '" + std::string(kernel.name()) + "': " + what);
}

[[noreturn]] void mistake(const char* call, const std::string& what) {
  throw std::logic_error(std::string(call) + ": " + what);
}

std::string text(const Slice& slice) {
  return std::to_string(slice.bytes) + " bytes at " + std::to_string(slice.offset) +
         (slice.buffer == nullptr ? " of no buffer"
                                  : " of buffer '" + slice.buffer->name + "' (" +
                                        std::to_string(slice.buffer->bytes) + " bytes)");
}

// Empty if the slice is a range of a buffer, else what is wrong with it.
std::string range_problem(const Slice& slice) {
  if (slice.buffer == nullptr) {
    return "there is no buffer";
  }
  if (slice.bytes == 0) {
    return "the slice is empty: " + text(slice);
  }
  if (slice.offset > slice.buffer->bytes || slice.bytes > slice.buffer->bytes - slice.offset) {
    return "the slice ends past its buffer: " + text(slice);
  }
  return {};
}

std::string size_problem(const Slice& slice, bool texels, const DeviceInfo& device) {
  if (!texels) {
    return slice.bytes <= device.max_storage_buffer_bytes
               ? ""
               : "a slice has at most " + std::to_string(device.max_storage_buffer_bytes) +
                     " bytes on " + device.name + ", given " + text(slice);
  }
  const uint64_t most = device.max_texel_buffer_elements;
  if (slice.bytes % kTexelBytes != 0 || slice.bytes / kTexelBytes > most) {
    return "texels are multiples of " + std::to_string(kTexelBytes) + " bytes, at most " +
           std::to_string(most) + " of them on " + device.name + ", given " + text(slice);
  }
  return {};
}

std::string binding_problem(const Slice& slice, bool texels, const Device& device) {
  if (std::string problem = range_problem(slice); !problem.empty()) {
    return problem;
  }
  if (slice.offset % kSliceAlignment != 0) {
    return "offsets are multiples of " + std::to_string(kSliceAlignment) + ", given " + text(slice);
  }
  if (std::string problem = size_problem(slice, texels, device.info); !problem.empty()) {
    return problem;
  }
  if (slice.buffer->device != &device) {
    return "the buffer belongs to another context: " + text(slice);
  }
  return {};
}

void check_dispatch(const Device& device, const Kernel& kernel, std::span<const std::byte> push,
                    std::span<const Slice> slices) {
  const Kernel::State& state = kernel.state();
  if (state.device != &device) {
    mistake(kernel, "it belongs to another context");
  }
  if (push.size() != state.reflection.push_bytes) {
    mistake(kernel, "push constants have " + std::to_string(state.reflection.push_bytes) +
                        " bytes, given " + std::to_string(push.size()));
  }
  if (slices.size() != state.reflection.bindings.size()) {
    mistake(kernel, "it binds " + std::to_string(state.reflection.bindings.size()) +
                        " buffers, given " + std::to_string(slices.size()));
  }
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const bool texels = state.reflection.bindings[i].texels;
    if (const std::string problem = binding_problem(slices[i], texels, device); !problem.empty()) {
      mistake(kernel, "binding " + std::to_string(i) + ": " + problem);
    }
  }
}

void check_words(const char* call, const Slice& slice) {
  if (const std::string problem = range_problem(slice); !problem.empty()) {
    mistake(call, problem);
  }
  if (slice.offset % 4 != 0 || slice.bytes % 4 != 0) {
    mistake(call, "offset and length are multiples of 4 bytes, given " + text(slice));
  }
}

vk::Buffer handle(const Slice& slice) {
  return *slice.buffer->handle;
}

// Binds pipeline, buffers and push constants for the dispatch that follows.
void bind(Recorder::State& state, const Kernel& kernel, std::span<const std::byte> push,
          std::span<const Slice> slices) {
  const Kernel::State& k = kernel.state();
  const vk::raii::CommandBuffer& commands = state.slot->commands();
  if (state.bound != &k) {
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *k.pipeline);
    state.bound = &k;
  }
  if (!slices.empty()) {
    const auto count = static_cast<uint32_t>(slices.size());
    const vk::DescriptorSet set = state.slot->descriptor_set(*k.set_layout, count);
    std::array<vk::DescriptorBufferInfo, kMaxBindings> buffers;
    std::array<vk::BufferView, kMaxBindings> views;
    std::array<vk::WriteDescriptorSet, kMaxBindings> writes;
    for (uint32_t i = 0; i < count; ++i) {
      writes[i] = vk::WriteDescriptorSet(set, i, 0, 1, vk::DescriptorType::eStorageBuffer);
      if (k.reflection.bindings[i].texels) {
        TexelView view = slices[i].buffer->texels(slices[i].offset, slices[i].bytes);
        views[i] = **view;
        state.slot->keep(std::move(view));
        writes[i].setDescriptorType(vk::DescriptorType::eUniformTexelBuffer);
        writes[i].setPTexelBufferView(&views[i]);
      } else {
        buffers[i] = vk::DescriptorBufferInfo(handle(slices[i]), slices[i].offset, slices[i].bytes);
        writes[i].setPBufferInfo(&buffers[i]);
      }
    }
    state.device->device.updateDescriptorSets(
        vk::ArrayProxy<const vk::WriteDescriptorSet>(count, writes.data()), {});
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *k.layout, 0, set, {});
  }
  if (!push.empty()) {
    commands.pushConstants<std::byte>(*k.layout, vk::ShaderStageFlagBits::eCompute, 0, push);
  }
}

CommandSlot& slot_of(const std::unique_ptr<Recorder::State>& state) {
  if (state == nullptr || state->slot == nullptr) {
    throw std::logic_error("the recorder was submitted or moved away: it records no more");
  }
  return *state->slot;
}

}  // namespace

Recorder::State::State(Device& owner) : device(&owner), slot(owner.begin_commands()) {}

Recorder::State::~State() {
  if (slot != nullptr) {
    device->recycle(std::move(slot));
  }
}

Recorder::Recorder(std::unique_ptr<State> state) : state_(std::move(state)) {
  barrier();
}
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&&) noexcept = default;
Recorder::~Recorder() {
  leave_to_parent(state_);
}

void Recorder::dispatch_bytes(const Kernel& kernel, uint32_t groups,
                              std::span<const std::byte> push, std::span<const Slice> slices) {
  const CommandSlot& slot = slot_of(state_);
  check_dispatch(*state_->device, kernel, push, slices);
  if (groups > kMaxGroups) {
    mistake(kernel, "a dispatch has at most " + std::to_string(kMaxGroups) + " groups, given " +
                        std::to_string(groups));
  }
  if (groups > 0) {
    bind(*state_, kernel, push, slices);
    slot.commands().dispatch(groups, 1, 1);
    ++state_->work.dispatches;
  }
}

void Recorder::dispatch_indirect_bytes(const Kernel& kernel, Slice args,
                                       std::span<const std::byte> push,
                                       std::span<const Slice> slices) {
  const CommandSlot& slot = slot_of(state_);
  check_dispatch(*state_->device, kernel, push, slices);
  if (const std::string problem = range_problem(args); !problem.empty()) {
    mistake(kernel, "indirect arguments: " + problem);
  }
  if (args.offset % 4 != 0 || args.bytes < kIndirectBytes) {
    mistake(kernel, "indirect arguments are 12 bytes at a multiple of 4, given " + text(args));
  }
  bind(*state_, kernel, push, slices);
  slot.commands().dispatchIndirect(handle(args), args.offset);
  ++state_->work.dispatches;
}

void Recorder::fill(Slice slice, uint32_t value) {
  const CommandSlot& slot = slot_of(state_);
  check_words("fill", slice);
  slot.commands().fillBuffer(handle(slice), slice.offset, slice.bytes, value);
  ++state_->work.copies;
}

void Recorder::copy(Slice from, Slice to) {
  const CommandSlot& slot = slot_of(state_);
  for (const Slice& slice : {from, to}) {
    if (const std::string problem = range_problem(slice); !problem.empty()) {
      mistake("copy", problem);
    }
  }
  if (from.bytes != to.bytes) {
    mistake("copy", "lengths differ: from " + text(from) + " to " + text(to));
  }
  if (from.buffer == to.buffer && from.offset < to.offset + to.bytes &&
      to.offset < from.offset + from.bytes) {
    mistake("copy", "the slices overlap: from " + text(from) + " to " + text(to));
  }
  slot.commands().copyBuffer(handle(from), handle(to),
                             vk::BufferCopy(from.offset, to.offset, from.bytes));
  ++state_->work.copies;
  state_->work.upload_bytes += from.buffer->kind == Memory::upload ? from.bytes : 0;
  state_->work.readback_bytes += to.buffer->kind == Memory::readback ? to.bytes : 0;
}

void Recorder::barrier() {
  using Stage = vk::PipelineStageFlagBits2;
  using Access = vk::AccessFlagBits2;
  const vk::MemoryBarrier2 everything(
      Stage::eComputeShader | Stage::eAllTransfer,
      Access::eShaderStorageWrite | Access::eTransferWrite,
      Stage::eComputeShader | Stage::eAllTransfer | Stage::eDrawIndirect,
      Access::eShaderStorageRead | Access::eShaderStorageWrite | Access::eShaderSampledRead |
          Access::eTransferRead | Access::eTransferWrite | Access::eIndirectCommandRead);
  slot_of(state_).commands().pipelineBarrier2(vk::DependencyInfo({}, everything));
  ++state_->work.barriers;
}

Recorder::Scope Recorder::scope(std::string_view name) {
  CommandSlot& slot = slot_of(state_);
  if (!state_->device->profile) {
    return {nullptr, 0};
  }
  return {this, translated("opening scope '" + std::string(name) + "'",
                           [&] { return slot.open_scope(name); })};
}

void Recorder::end_scope(uint32_t index) {
  slot_of(state_).close_scope(index);
}

Recorder::Scope::~Scope() {
  if (recorder_ != nullptr) {
    recorder_->end_scope(index_);
  }
}

}  // namespace adit::engine
