// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <variant>
#include <vector>

#include "adit/tools/recordings/recording.hpp"

namespace adit::test {

/// The sweep with this index on the recording's first topic.
inline Sweep read_sweep(const Recording& recording, std::size_t index) {
  return std::get<Sweep>(recording.events({.topics = {0}, .skip = index})->next().value().value);
}

/// A recording as far as it can be read.
struct ReadEvents {
  std::vector<Event> events;
  std::vector<InputError> errors;
};

inline ReadEvents read_all(const Recording& recording, const EventSelection& selection = {}) {
  ReadEvents read;
  const auto stream = recording.events(selection);
  for (bool more = true; more;) {
    try {
      auto event = stream->next();
      more = event.has_value();
      if (event) {
        read.events.push_back(std::move(*event));
      }
    } catch (const InputError& error) {
      read.errors.push_back(error);
    }
  }
  return read;
}

}  // namespace adit::test
