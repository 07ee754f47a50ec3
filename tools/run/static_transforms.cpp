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

std::vector<StaticTransform> transforms_within(const Recording& recording,
                                               const EventSelection& selection) {
  std::vector<StaticTransform> transforms;
  const auto events = recording.events(selection);
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

}  // namespace

std::vector<StaticTransform> static_transforms(const Recording& recording) {
  EventSelection selection;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    if (recording.topics()[i].kind == TopicKind::transforms) {
      selection.topics.push_back(i);
    }
  }
  if (selection.topics.empty()) {
    return {};
  }
  // Whoever reads on reports the damage.
  const auto whole = pass_over_damage(recording, [](const InputError&) {});
  // Usually they come at the beginning: the rest of the recording is not read for them.
  if (const std::optional<Event> first = whole->events({})->next()) {
    selection.end = first->received + 2 * kLookAhead;
    if (auto transforms = transforms_within(*whole, selection); !transforms.empty()) {
      return transforms;
    }
  }
  selection.end = Nanoseconds::max();
  return transforms_within(*whole, selection);
}

}  // namespace adit
