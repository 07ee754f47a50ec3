// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The clock of a topic against the recorder's: constant but for delays, until it steps.
#pragma once

#include <cstdint>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// Messages in a row between two steps of their clock.
struct ClockStretch {
  uint64_t events = 0;
  Nanoseconds begin{0};        ///< receipt of the first
  Nanoseconds first{0};        ///< its stamp
  Nanoseconds last{0};         ///< stamp of the last
  Nanoseconds least{0};        ///< least stamp
  Nanoseconds greatest{0};     ///< greatest stamp
  double least_delay = 0.0;    ///< s from stamp to receipt
  double sum_of_delays = 0.0;  ///< s

  double mean_delay() const {
    return events == 0 ? 0.0 : sum_of_delays / static_cast<double>(events);
  }
};

/// Where a clock leaps, against the recorder's.
struct ClockStep {
  double seconds = 0.0;   ///< by how much; negative: it falls back
  double after = 0.0;     ///< s of the recorder's clock after the topic's first message
  Nanoseconds before{0};  ///< last stamp before the step
  Nanoseconds stamp{0};   ///< first stamp after it
};

/// Finds steps of a second and more. Messages that were delayed and stray stamps are none: a step
/// lasts for three messages, and the least delays before and after it differ.
class ClockWatch {
 public:
  void add(Nanoseconds received, Nanoseconds stamp);

  /// In order.
  std::vector<ClockStep> steps() const;
  /// s from stamp to receipt, the mean of the stretch with the most messages; 0 without any.
  double typical_delay() const;
  /// s from the first stamp to the last, without the steps.
  double span() const;

 private:
  /// Those of three messages and more, one of all where there are none; neighbours whose clocks
  /// agree are one.
  std::vector<ClockStretch> joined() const;

  std::vector<ClockStretch> stretches_;
  Nanoseconds last_received_{0};
};

}  // namespace adit
