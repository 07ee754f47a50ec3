// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

#include "adit/slam/fusion/sliding_graph.hpp"
#include "adit/slam/inertial/preintegration.hpp"

namespace adit {

/// The body at the time of one inertial reading.
struct HighRateState {
  NavState nav;
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< rad/s, without its bias, body
  StateMatrix covariance = StateMatrix::Zero();                ///< in the order of tangent vectors
};

/// Odometry at the rate of the inertial sensor: the newest estimate, carried forward with each
/// reading. Stamps only rise. An estimate corrects what came before it by millimetres; with
/// smoothing the correction is spread over that time instead of showing as a step.
class HighRateOdometry {
 public:
  /// `smoothing` in s, 0 for none.
  HighRateOdometry(const ImuNoise& noise, double smoothing)
      : noise_(noise), smoothing_(smoothing) {}

  /// A new estimate, of a time that readings have passed by some tenths of a second at most.
  void correct(const StateEstimate& estimate);

  /// Forgets the estimate and the readings: nothing is known until the next correct().
  void stop();

  /// The next reading, m/s². None before the first estimate, or where its stamp does not rise.
  std::optional<HighRateState> add(const ImuSample& sample);

 private:
  HighRateState forecast(const ImuSample& at) const;

  ImuNoise noise_;
  double smoothing_;
  std::optional<StateEstimate> base_;
  Preintegration since_;
  std::deque<ImuSample> readings_;          ///< from the base's stamp on, interpolated at it
  Vector6d correction_ = Vector6d::Zero();  ///< pose correction that has still to be spread
  Nanoseconds corrected_at_{0};
};

}  // namespace adit
