// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "adit/slam/odometry/odometry.hpp"

namespace adit {

/// What a trajectory, or a part of it, is worth.
enum class Trust {
  reliable,
  doubtful,  ///< it may be wrong by more than its covariance says
  lost,      ///< it is a guess
};
/// The enumerator's name.
std::string_view to_string(Trust trust);

/// Why a stretch is not reliable.
enum class DoubtCause {
  unheld,     ///< the sensor moved along, or turned about, what no match held
  predicted,  ///< no sweep could be aligned for too long
  /// Alignments and inertial predictions contradict each other, one after another; without an IMU,
  /// alignments alone: steps that no sensor makes.
  contradicted,
  new_start,  ///< the map began anew: how its pieces lie to each other inertia tells, or nothing
  silence,  ///< for long there was no sweep; the first one after it fits, and nothing confirms that
};
/// The enumerator's name.
std::string_view to_string(DoubtCause cause);

/// Sweeps in a row that are not reliable.
struct DoubtfulStretch {
  DoubtCause cause = DoubtCause::unheld;  ///< why it is doubted
  Trust trust = Trust::doubtful;          ///< how much
  size_t first = 0;                       ///< sweep, counted from the first that was placed
  size_t last = 0;                        ///< the last one
  Nanoseconds begin{0};                   ///< stamps of these two
  Nanoseconds end{0};                     ///< stamp of the last
  double distance = 0.0;                  ///< m, travelled in it by the estimate
  size_t fused = 0;                       ///< sweeps of it in which an inertial sensor was fused
  size_t measured = 0;  ///< sweeps of it that measured velocities led to, without one
  double alone = 0.0;   ///< m, travelled in it without one
  /// m, of the way since its first sweep, along what was held least: standard deviation, at most.
  double sigma = 0.0;
  /// unheld: the direction of translation that was held least, map frame, unit; zero where it was a
  /// turn alone.
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  /// contradicted: the median of the squared innovations per degree of freedom; about 1 is right. 0
  /// without an IMU.
  double innovation = 0.0;
  double silence = 0.0;  ///< silence, new_start: s without an aligned sweep before its last one
  /// new_start: loops or GNSS tie the map before it to the map after it.
  bool tied = false;

  /// An inertial sensor was fused in most of it.
  bool inertial() const { return 2 * fused > last - first + 1; }
  /// Measured velocities, whose scale nobody had compared, led through most of it.
  bool by_velocities() const { return 2 * measured > last - first + 1; }
};

/// Loops moved keyframes of the map against each other by more than the odometry bears out: it
/// drifted more than its covariances say, or another place was taken for this one.
struct MovedByLoops {
  double distance = 0.0;  ///< m
  double sigmas = 0.0;    ///< standard deviations of the odometry's relative pose
  double path = 0.0;      ///< m of odometry between the two
};
/// More of MovedByLoops::sigmas than this are doubtful.
inline constexpr double kMostLoopSigmas = 5.0;

/// What a run is worth: as much as its worst stretch.
struct Verdict {
  Trust trust = Trust::reliable;           ///< of the run as a whole
  std::vector<DoubtfulStretch> stretches;  ///< by their causes, and in order of time
  std::optional<MovedByLoops> moved{};     ///< set if that is not reliable
};

/// The same with what loops did to the map.
Verdict with_loops(Verdict verdict, const MovedByLoops& moved);

/// Watches the results of a run as they come and says where they are not to be relied on
/// (docs/theory/odometry.md, section 5). It needs no truth, and cannot see everything: what it
/// calls reliable is what nothing speaks against.
class RunAssessor {
 public:
  /// Each sweep's result once, in their order.
  void add(const SweepResult& result);
  /// The verdict on all sweeps so far.
  Verdict verdict() const;

 private:
  struct Seen {
    Nanoseconds stamp{0};
    Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
    double step = 0.0;  ///< m since the sweep before
    PoseUncertainty uncertainty;
    bool aligned = false;
    bool unheld = false;
    bool inertial = false;
    bool measured = false;
    bool leapt = false;
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unheld, map frame
    double innovation = 0.0;  ///< squared, per degree of freedom; negative: none
  };

  static UncertainPose pose_of(const Seen& seen);
  void look_for_unheld();
  void forget_unheld();
  void look_for_contradiction();
  void look_for_leaps();
  void look_for_prediction();
  /// The last `sweeps` of them are doubtful: a new stretch, or more of the last one of that cause.
  DoubtfulStretch& note(DoubtCause cause, size_t sweeps);

  std::deque<Seen> recent_;
  size_t count_ = 0;
  size_t aligned_ = 0;
  size_t since_aligned_ = 0;  ///< sweeps
  double alone_ = 0.0;        ///< s since the last aligned sweep
  double path_ = 0.0;         ///< m
  std::vector<DoubtfulStretch> stretches_;
  std::vector<UncertainPose> begins_;  ///< poses of the stretches' first sweeps
};

}  // namespace adit
