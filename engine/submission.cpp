// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/submission.hpp"

#include <stdexcept>

#include "adit/engine/vulkan/process.hpp"
#include "adit/engine/vulkan/submission_state.hpp"

namespace adit::engine {

RecordedWork& RecordedWork::operator+=(const RecordedWork& other) {
  submissions += other.submissions;
  dispatches += other.dispatches;
  barriers += other.barriers;
  copies += other.copies;
  upload_bytes += other.upload_bytes;
  readback_bytes += other.readback_bytes;
  return *this;
}

Submission::State::State(Device& owner, std::unique_ptr<CommandSlot> commands, uint64_t at,
                         const RecordedWork& recorded)
    : device(&owner), slot(std::move(commands)), value(at), work(recorded) {}

Submission::State::~State() {
  try {
    wait();
  } catch (const Error&) {
    // Whoever needs to know that the device is lost waits by name; commands and buffers can go now.
  }
}

void Submission::State::wait() {
  if (slot == nullptr) {
    return;
  }
  device->wait(value);
  times = translated("reading timestamps",
                     [&] { return slot->scope_times(device->ns_per_tick, device->tick_mask); });
  device->recycle(std::move(slot));
}

Submission::Submission(std::unique_ptr<State> state) : state_(std::move(state)) {}
Submission::Submission(Submission&&) noexcept = default;
Submission& Submission::operator=(Submission&&) noexcept = default;
Submission::~Submission() {
  leave_to_parent(state_);
}

void Submission::wait() {
  state_->wait();
}

bool Submission::done() const {
  return state_->slot == nullptr || state_->device->reached(state_->value);
}

const RecordedWork& Submission::recorded() const {
  return state_->work;
}

const std::vector<ScopeTime>& Submission::scope_times() const {
  if (state_->slot != nullptr) {
    throw std::logic_error("scope_times() is read before wait()");
  }
  return state_->times;
}

}  // namespace adit::engine
