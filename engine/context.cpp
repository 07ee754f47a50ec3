// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/context.hpp"

#include <stdexcept>

#include "adit/engine/vulkan/buffer_state.hpp"
#include "adit/engine/vulkan/process.hpp"
#include "adit/engine/vulkan/recorder_state.hpp"
#include "adit/engine/vulkan/submission_state.hpp"

namespace adit::engine {

Context::Context(const ContextOptions& options) {
  note_opened_device();  // before a driver is loaded
  device_ = std::make_unique<Device>(options);
}
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&&) noexcept = default;
Context::~Context() {
  leave_to_parent(device_);
}

const DeviceInfo& Context::device() const {
  return device_->info;
}
bool Context::software_fallback() const {
  return device_->software_fallback;
}

Buffer Context::make_buffer(uint64_t bytes, Memory kind, std::string_view name) {
  require_device_process();
  return Buffer(std::make_unique<Buffer::State>(*device_, bytes, kind, name));
}

uint64_t Context::memory_in_use() const {
  return device_->memory->in_use();
}
uint64_t Context::memory_peak() const {
  return device_->memory->peak();
}
uint64_t Context::memory_reserved() const {
  return device_->memory->reserved();
}

Recorder Context::make_recorder() {
  return Recorder(std::make_unique<Recorder::State>(*device_));
}

Submission Context::submit(Recorder&& recorder) {
  if (recorder.state_ == nullptr || recorder.state_->slot == nullptr) {
    throw std::logic_error("submit: the recorder was submitted or moved away before");
  }
  Recorder::State& state = *recorder.state_;
  if (state.slot->scopes_open()) {
    throw std::logic_error("submit: a scope of the recorder is still open");
  }
  if (state.device != device_.get()) {
    throw std::logic_error("submit: the recorder belongs to another context");
  }
  // What the device wrote is there for the host once it has waited.
  using Stage = vk::PipelineStageFlagBits2;
  using Access = vk::AccessFlagBits2;
  const vk::MemoryBarrier2 to_host(Stage::eComputeShader | Stage::eAllTransfer,
                                   Access::eShaderStorageWrite | Access::eTransferWrite,
                                   Stage::eHost, Access::eHostRead);
  state.slot->commands().pipelineBarrier2(vk::DependencyInfo({}, to_host));
  translated("ending a recording", [&] { state.slot->end(); });
  const uint64_t value = device_->submit(*state.slot);
  state.work.submissions = 1;
  return Submission(
      std::make_unique<Submission::State>(*device_, std::move(state.slot), value, state.work));
}

std::vector<std::byte> Context::pipeline_cache() const {
  return device_->pipeline_cache_data();
}

void Context::add_to_pipeline_cache(std::span<const std::byte> earlier) {
  device_->add_to_pipeline_cache(earlier);
}

std::vector<KernelStatistics> Context::kernel_statistics() const {
  const std::scoped_lock lock(device_->statistics_mutex);
  return device_->statistics;
}

std::vector<std::string> Context::validation_messages() const {
  return device_->instance.log->messages();
}

}  // namespace adit::engine
