// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "adit/slam/inertial/rotation_comparison.hpp"
#include "adit/slam/inertial/sweep_motion.hpp"

namespace adit {

/// What is wrong with a gyroscope whose turns are not those of the sweeps.
enum class GyroFault {
  none,       ///< nothing, or nothing that the motion tells
  constant,   ///< it does not move while the sweeps turn
  unrelated,  ///< it moves, and has no motion in common with them
  unit,       ///< it turns many times more, or less
  scale,      ///< some per cent more, or less
  clock,
  mounting,
};
std::string_view to_string(GyroFault fault);

/// What the comparison is held to.
struct GyroExpectation {
  Eigen::Matrix3d R_lidar_imu = Eigen::Matrix3d::Identity();
  double offset = 0.0;      ///< s, as RotationComparison::offset
  double tolerance = 0.0;   ///< s, how far from that it may be
  double configured = 0.0;  ///< s, recording.imu_time_offset: in the stamps already
  /// Stamps of readings at the end of the gyroscope's range, in order: turns near them do not
  /// count.
  std::vector<Nanoseconds> saturated;
};

/// The sensor held against the sweeps over the last while.
struct GyroCheck {
  GyroFault fault = GyroFault::none;
  std::size_t turns = 0;  ///< number of compared turns of the sweeps, from each to the next
  double factor = 0.0;    ///< how much the gyroscope's turns vary, over how much the sweeps' do
  double configured_offset = 0.0;                  ///< s, as GyroExpectation::configured
  std::optional<RotationComparison> comparison{};  ///< none where the motion does not tell it
};

/// Compares the turns of aligned sweeps with the gyroscope's, over the last fifteen seconds or so
/// (docs/theory/inertial.md, section 10). Readings and stamps as they come: what is reported of the
/// clock and the mounting is all there is, whatever is corrected elsewhere.
class GyroMonitor {
 public:
  void add(const ImuSample& sample);

  /// The next sweep's alignment (T_map_lidar), with what the sweep was de-skewed with, if it was:
  /// what it says of the attitude at the stamp hangs on that, and of the mean attitude it does not.
  /// `broken` where there is no alignment: no turn leads there.
  void add(const StampedPose& alignment, const SweepMotion* deskewed = nullptr);
  void broken() { last_.reset(); }
  /// Sweeps so far took after a sensor that was not right.
  void forget_turns() {
    turns_.clear();
    unchecked_ = 0;
  }

  /// With every twentieth turn, from the thirtieth on; none in between. Turns that the readings do
  /// not tell do not count, and fewer than kLeastRotations others tell nothing.
  std::optional<GyroCheck> check(const GyroExpectation& expected);

 private:
  std::deque<ImuSample> samples_;
  std::deque<RotationInterval> turns_;
  std::optional<MeanAttitude> last_;
  int unchecked_ = 0;  ///< turns since the last check
};

}  // namespace adit
