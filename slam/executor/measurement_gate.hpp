// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "adit/slam/executor/sensor_feed.hpp"

namespace adit {

/// Values that no sensor measures (NaN, infinite, impossible), counted by kind.
struct MeasurementFaults {
  std::size_t fixes = 0;                 ///< GNSS fixes that were added
  std::size_t fixes_left_out = 0;        ///< without a finite latitude and longitude
  std::size_t fixes_without_height = 0;  ///< without a finite altitude, or a finite variance of it
  std::size_t fixes_without_covariance = 0;       ///< covariance not finite or negative: not used
  std::size_t velocities = 0;                     ///< measured velocities that were added
  std::size_t velocities_left_out = 0;            ///< infinite, or not measured on any axis
  std::size_t velocities_without_covariance = 0;  ///< covariance that none can be: not used
  std::size_t headings = 0;                       ///< measured headings that were added
  std::size_t headings_left_out = 0;              ///< not finite
  std::size_t headings_without_sigma = 0;  ///< deviation not finite or not positive: not used
  std::size_t intensities = 0;             ///< points whose intensity is not finite: 0 instead
  std::size_t times = 0;                   ///< points whose time no sweep has: they have none
  std::size_t transforms = 0;              ///< static transforms that are not finite: left out

  /// There is a fault at all.
  bool any() const {
    return fixes_left_out + fixes_without_height + fixes_without_covariance + velocities_left_out +
               velocities_without_covariance + headings_left_out + headings_without_sigma +
               intensities + times + transforms >
           0;
  }
};

/// The boundary of the system: behind it every number is finite, but for the coordinates of points
/// without a return, which the device drops. (Inertial readings have their own gate,
/// slam/inertial/reading_gate.hpp, which judges them against each other as well.)
class MeasurementGate {
 public:
  /// The measurement as it counts; nothing where none of it does.
  std::optional<Measurement> pass(Measurement measurement);
  /// False: the transform is not finite.
  bool pass(const StaticTransform& transform);

  const MeasurementFaults& faults() const { return faults_; }

 private:
  void mend(Sweep& sweep);
  bool mend(GnssFix& fix);
  bool mend(BodyVelocity& velocity);
  bool mend(Heading& heading);

  MeasurementFaults faults_;
  double last_altitude_ = 0.0;  ///< m, of the last fix that had one
};

}  // namespace adit
