// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/prediction.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/slam/odometry/silence.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

inline constexpr double kHardlyMoves = 0.5;  // m/s
/// Nobody moves at constant velocity for longer than this.
inline constexpr double kLongestExtrapolation = 1.0;  // s

/// Less than kHardlyMoves along the directions that the alignment's matches hold, 1 m/s along those
/// that few do; where no match holds a direction, a motion along it is noise.
bool hardly_moves(const RegistrationResult& alignment, const StampedPose& from,
                  const StampedPose& to);

/// Constant velocity: the last motion from one aligned sweep to the next, scaled by the time since
/// then, for a second at most.
class MotionModel {
 public:
  Prediction predict(Nanoseconds stamp) const;
  /// A sweep was aligned (trusted), or bridged by its prediction (not).
  void update(const StampedPose& pose, bool aligned);
  /// Nothing is known but where the sensor is.
  void restart(const StampedPose& pose);
  /// The mean twist of the last two motions, in the lidar's axes, m/s and rad/s: what to de-skew
  /// with. (With the last motion's alone an error of the twist would come back with the opposite
  /// sign at each sweep, undamped: docs/theory/inertial.md, section 7.)
  Vector6d deskewing_twist() const { return 0.5 * (velocity_ + velocity_before_); }
  double speed() const { return velocity_.head<3>().norm(); }  ///< m/s, of the last motion
  /// What is possible by `stamp`, after the last sweep that was aligned or started from; there must
  /// have been one.
  Silence silence_until(Nanoseconds stamp) const;
  /// s since that sweep; 0 before the first.
  double unseen(Nanoseconds stamp) const { return seen_ ? seconds(stamp - seen_->stamp) : 0.0; }
  /// Where it goes on from; none before the first sweep.
  const std::optional<StampedPose>& last() const { return last_; }

 private:
  /// Of the last two motions.
  const Vector6d& slower_velocity() const;
  /// The velocity of long ago says nothing of now's.
  void stop();

  std::optional<StampedPose> last_;
  std::optional<StampedPose> seen_;       ///< the last that was aligned, or started from
  Vector6d velocity_ = Vector6d::Zero();  ///< twist in the body frame, m/s and rad/s
  Vector6d velocity_before_ = Vector6d::Zero();
  bool moved_ = false;    ///< the velocity has been seen
  double fastest_ = 0.0;  ///< m/s, of two motions in a row
  int aligned_in_a_row_ = 0;
};

}  // namespace adit
