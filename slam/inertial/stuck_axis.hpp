// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "adit/slam/core/types.hpp"

namespace adit {

/// An axis that reads one and the same value while others of its sensor move.
struct StuckAxis {
  bool gyroscope = true;  ///< else the accelerometer
  int axis = 0;           ///< 0, 1, 2: x, y, z
  double value = 0.0;     ///< rad/s, or the accelerometer's own unit
  double duration = 0.0;  ///< s, so far
};

/// Finds axes that are stuck: the same value, bit for bit, for half a second and fifty readings,
/// while the other axes go up and down by 0.1 rad/s or 0.5 of the accelerometer's unit. An axis
/// that has never changed is none: sensors of flat worlds have such. (An axis at the end of its
/// range is SaturationWatch's.)
class StuckAxisWatch {
 public:
  /// The next reading, in order of time.
  void add(const ImuSample& sample);

  /// Stuck as of the last reading.
  std::optional<StuckAxis> stuck() const;
  /// One and the same value as long, since `latest` or before, while the others go up and down by
  /// ten times the smallest step that the axis has ever made. That alone is no fault (drivers may
  /// round what is small to 0): it names the cause where there is one.
  std::optional<StuckAxis> unchanged(Nanoseconds latest = Nanoseconds::max()) const;

 private:
  struct Axis {
    double value = 0.0;
    Nanoseconds since{0};
    int readings = 0;
    int changes = 0;
    double least_step = std::numeric_limits<double>::infinity();  ///< of its changes
    Eigen::Vector3d least = Eigen::Vector3d::Zero();  ///< minimum of the sensor's axes since then
    Eigen::Vector3d greatest = Eigen::Vector3d::Zero();
  };
  using Triad = std::array<Axis, 3>;

  static void add(Triad& triad, const Eigen::Vector3d& value, Nanoseconds stamp);
  struct Bounds {
    double least = 0.0;  ///< the others move by more
    double steps = 0.0;  ///< and by more of the axis's smallest steps
    Nanoseconds latest = Nanoseconds::max();
  };
  static std::optional<StuckAxis> stuck(const Triad& triad, const Bounds& bounds, Nanoseconds now);

  Triad gyroscope_{};
  Triad accelerometer_{};
  Nanoseconds last_{0};
};

}  // namespace adit
