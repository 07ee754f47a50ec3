// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "adit/tools/clouds/point_times.hpp"

namespace adit {

/// The unit of a topic's point times, from its first sweeps: one sweep alone may be cut short and
/// look like another unit. The sweep with the most steps between its first and last point decides.
class PointTimeVote {
 public:
  static constexpr std::size_t kSweeps = 5;  ///< as many are asked

  /// Takes a sweep that was read without knowing the unit.
  void add(const Sweep& sweep, const PointTimeNature& nature) {
    const float last = sweep.times.empty() ? 0.0F : *std::ranges::max_element(sweep.times);
    const double steps = static_cast<double>(last) / nature.unit;
    if (steps > most_steps_) {
      most_steps_ = steps;
      unit_ = nature.unit;
    }
  }

  /// s; none where no sweep has points at different times.
  std::optional<double> unit() const { return unit_; }

 private:
  double most_steps_ = 0.0;
  std::optional<double> unit_;
};

}  // namespace adit
