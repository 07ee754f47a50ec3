// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "slam/lie.hpp"
#include "slam/types.hpp"

namespace adit {

/// Where the next sweep is expected, and whether to trust it.
struct Prediction {
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  /// The velocity is known from aligned sweeps. If not, the alignment has to search.
  bool trusted = false;
};

/// Constant velocity: the last motion, scaled by the time since then.
class MotionModel {
 public:
  Prediction predict(Nanoseconds stamp) const;
  /// A sweep was aligned (trusted), or bridged by its prediction (not).
  void update(const StampedPose& pose, bool aligned);
  /// Nothing is known but where the sensor is.
  void restart(const StampedPose& pose);

 private:
  std::optional<StampedPose> last_;
  Vector6d velocity_ = Vector6d::Zero();  ///< twist in the body frame, m/s and rad/s
  int aligned_in_a_row_ = 0;
};

}  // namespace adit
