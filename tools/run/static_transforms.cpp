// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/static_transforms.hpp"

#include <cstddef>
#include <optional>
#include <variant>

#include "adit/tools/recordings/tolerant_recording.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kLookAhead = std::chrono::seconds(10);

}  // namespace

std::vector<StaticTransform> static_transforms(const Recording& recording) {
  std::vector<StaticTransform> transforms;
  std::vector<std::size_t> topics;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    if (recording.topics()[i].kind == TopicKind::transforms) {
      topics.push_back(i);
    }
  }
  if (topics.empty()) {
    return transforms;
  }
  // Whoever reads on reports the damage.
  const auto whole = pass_over_damage(recording, [](const InputError&) {});
  const auto events = whole->events({.topics = topics});
  std::optional<Nanoseconds> begin;
  while (const std::optional<Event> event = events->next()) {
    begin = begin.value_or(event->received);
    if (event->received > *begin + kLookAhead) {
      break;
    }
    transforms.push_back(std::get<StaticTransform>(event->value));
  }
  return transforms;
}

}  // namespace adit
