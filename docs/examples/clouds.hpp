// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The first sweep of a file in any format that adit reads.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "adit/tools/recordings/recording.hpp"

inline std::vector<adit::Point> first_cloud(const std::string& file) {
  const auto recording = adit::open_recording(file);
  const auto events = recording->events({});
  while (auto event = events->next()) {
    if (auto* sweep = std::get_if<adit::Sweep>(&event->value)) {
      return std::move(sweep->points);
    }
  }
  throw std::runtime_error(file + " has no points");
}
