// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_rehearsal.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <variant>

#include "adit/slam/odometry/odometry.hpp"
#include "adit/tools/recordings/tolerant_recording.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

void rehearse(const Recording& recording, std::size_t topic, const SweepRange& range,
              const Config& config, engine::Context& context) {
  constexpr std::size_t kSweeps = 2;  // the second is the first that is aligned
  std::optional<InputError> damage;
  const auto whole = pass_over_damage(recording, [&](const InputError& error) {
    if (!damage) {
      damage.emplace(error);
    }
  });
  const auto events = whole->events({.topics = {topic}, .skip = range.first});
  Odometry odometry(context, config);
  for (std::size_t i = 0; i < std::min(kSweeps, range.count); ++i) {
    const std::optional<Event> event = events->next();
    if (!event && i == 0 && damage) {
      throw InputError(*damage);
    }
    if (!event) {
      return;
    }
    static_cast<void>(odometry.step(std::get<Sweep>(event->value)));
  }
}

}  // namespace adit
