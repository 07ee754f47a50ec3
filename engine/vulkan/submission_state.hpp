// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "adit/engine/submission.hpp"
#include "adit/engine/vulkan/device.hpp"

namespace adit::engine {

struct Submission::State {
  State(Device& owner, std::unique_ptr<CommandSlot> commands, uint64_t at,
        const RecordedWork& recorded);
  ~State();
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void wait();

  Device* device;
  std::unique_ptr<CommandSlot> slot;  // null once the work is done and its times are read
  uint64_t value;                     // the timeline's value when the work is done
  RecordedWork work;
  std::vector<ScopeTime> times;
};

}  // namespace adit::engine
