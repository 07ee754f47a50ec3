// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What each source was worth for the motion, over the sweeps of a run.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/fusion/inertial_report.hpp"

namespace adit {

/// Shares of the information about the motion, the mean over sweeps, and the innovations of
/// alignments.
class ShareStatistics {
 public:
  void add(const InertialReport& report);

  /// By the names of the parts, 1 over all sources: those parts for which there were sweeps.
  std::vector<std::pair<std::string, double>> of(MotionSource source) const;
  /// Of alignments against the IMU's prediction: squared, a degree of freedom, the mean.
  std::optional<double> innovation_squared() const;

 private:
  MotionShares sum_{};
  std::size_t sweeps_ = 0;
  std::size_t moved_ = 0;  ///< of them: the others have no path
  double squares_ = 0.0;
  double degrees_ = 0.0;
};

}  // namespace adit
