// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "slam/types.hpp"

namespace adit {

/// How events came over time, in so many equal bins that memory stays small: where a recording
/// outgrows them, two bins become one.
class TopicTimeline {
 public:
  struct Bin {
    double events = 0.0;
    double largest_interval = 0.0;  ///< s, between two stamps, the later one in this bin
    double least_delay = 0.0;       ///< s from stamp to receipt; both 0 without events
    double greatest_delay = 0.0;
  };

  /// `interval` (s) since the stamp before, 0 for the first. What was received before the first
  /// event counts with it.
  void add(Nanoseconds received, double interval, double delay);

  Nanoseconds begin() const { return begin_.value_or(Nanoseconds(0)); }
  double bin_width() const { return width_; }  ///< s
  const std::vector<Bin>& bins() const { return bins_; }

 private:
  void double_width();

  std::optional<Nanoseconds> begin_;
  double width_ = 0.1;
  std::vector<Bin> bins_;
};

}  // namespace adit
