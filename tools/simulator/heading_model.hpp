// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adit/slam/core/types.hpp"
#include "adit/tools/simulator/spline.hpp"

namespace adit {

/// How a source of headings errs.
struct HeadingErrors {
  double sigma = 1.0;   ///< degrees
  double offset = 0.0;  ///< degrees, counter-clockwise, the same throughout
};

/// Throws UsageError where they are no errors that a heading can have.
void require_heading_errors(const HeadingErrors& errors);

/// Headings of the antenna's frame, whose x axis is that of the IMU's, against true north: as two
/// antennas give them. Errors are the sum of a Gauss-Markov process of 60 s, which has nine tenths
/// of the variance, and white noise, as those of fixes are.
class HeadingSimulator {
 public:
  /// The trajectory must outlive it. `rate` in Hz; `p_imu_antenna` in m.
  HeadingSimulator(const HeadingErrors& errors, int rate, const SplineTrajectory& trajectory,
                   const Eigen::Vector3d& p_imu_antenna, uint64_t seed);

  /// The next one; its stamp is counted from the start of the recording.
  Heading next();

 private:
  HeadingErrors errors_;
  int64_t period_;  ///< ns
  const SplineTrajectory* trajectory_;
  Eigen::Vector3d p_imu_antenna_;
  uint64_t seed_;
  double drift_;  ///< with unit variance
  int64_t index_ = 0;
};

}  // namespace adit
