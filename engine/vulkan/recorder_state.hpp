// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "adit/engine/recorder.hpp"
#include "adit/engine/submission.hpp"
#include "adit/engine/vulkan/device.hpp"

namespace adit::engine {

struct Recorder::State {
  explicit State(Device& owner);
  ~State();  // a recording that was not submitted goes back
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  Device* device;
  std::unique_ptr<CommandSlot> slot;  // null once submitted
  const Kernel::State* bound = nullptr;
  RecordedWork work;
};

}  // namespace adit::engine
