// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is counted and timed while a recording is mapped.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/slam/odometry/verdict.hpp"
#include "adit/tools/report/inertial_statistics.hpp"
#include "adit/tools/report/left_out.hpp"
#include "adit/tools/report/share_statistics.hpp"
#include "adit/tools/report/velocity_statistics.hpp"

namespace adit {

struct Distribution {
  std::size_t count = 0;
  double mean = 0.0;
  double p50 = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};

/// Percentiles are the smallest value that at least that share of the values does not exceed.
Distribution distribution(std::vector<float> values);

/// Time of one sweep by what it was spent on, ms.
struct HostTimes {
  double read = 0.0;       ///< reading and decoding the file, in a thread beside all else
  double read_wait = 0.0;  ///< waiting until that was done
  double host = 0.0;       ///< host work of the odometry
  double wait = 0.0;       ///< waiting for the device
  double map = 0.0;        ///< waiting for the map
  double write = 0.0;      ///< writing the results
  double total = 0.0;      ///< on the clock, from the end of the sweep before to that of this one
  double inertial = 0.0;   ///< part of `host`: preintegration and the sliding graph
};

/// A sweep that could not be placed.
struct SweepFailure {
  std::size_t index = 0;  ///< in the recording, counted from 0
  std::string source;     ///< its file
  OdometryState state = OdometryState::coasting;
  RegistrationStatus status = RegistrationStatus::too_few_points;
  std::string reason;  ///< for people, with the numbers
};

/// Why a sweep failed, with the settings that decided; nothing where it did not fail.
std::optional<std::string> failure_reason(const SweepResult& sweep, const Config& config);

/// Times of a named stage, one value a sweep, ms.
struct StageTimes {
  std::string stage;
  std::vector<float> ms;
};

/// A kind of work that the device is given, one value a sweep.
struct WorkCounts {
  std::string name;
  std::vector<float> counts;
};

/// "submissions", "dispatches", "barriers", "copies", "KiB up" and "KiB down".
std::vector<WorkCounts> counts_by_kind(const std::vector<engine::RecordedWork>& sweeps);

/// Adds up sweeps.
class RunStatistics {
 public:
  explicit RunStatistics(const Config& config) : config_(config) {}

  /// Takes the next sweep; returns its failure, if it is one.
  std::optional<SweepFailure> add(std::size_t index, const Sweep& sweep, const SweepResult& result,
                                  const HostTimes& times);

  /// Takes the next reading of the inertial sensor.
  void add(ImuArrival arrival) { inertial_.add(arrival); }

  /// What could not be used.
  LeftOut& left_out() { return left_out_; }
  const LeftOut& left_out() const { return left_out_; }

  /// m. What was subtracted from the coordinates of the sweeps (Sweep::offset).
  const Eigen::Vector3d& coordinate_offset() const { return coordinate_offset_; }

  /// The stamp of the sweep that was added last.
  std::optional<Nanoseconds> last_stamp() const {
    return first_ ? std::optional(last_.stamp) : std::nullopt;
  }

  std::optional<Nanoseconds> first_stamp() const {
    return first_ ? std::optional(first_->stamp) : std::nullopt;
  }
  /// On all sweeps so far and, once it is known, on what loops did to the map.
  Verdict verdict() const { return with_loops(assessor_.verdict(), moved_by_loops_); }
  void note(const MovedByLoops& moved) { moved_by_loops_ = moved; }

  /// Of the sweeps that were placed, in the recording; 0 before the first.
  std::size_t first_index() const { return first_index_; }
  std::size_t last_index() const { return last_index_; }
  /// Sweeps of the recording in a row, between two that were placed.
  std::size_t longest_missing() const { return longest_missing_; }

  std::size_t sweeps() const { return sweeps_; }
  std::size_t deskewed() const { return deskewed_; }  ///< sweeps
  const InertialStatistics& inertial() const { return inertial_; }
  const VelocityFusionStatistics& velocity() const { return velocity_; }
  const ShareStatistics& shares() const { return shares_; }
  /// In force.
  const Config& config() const { return config_; }
  std::size_t keyframes() const { return keyframes_; }
  std::size_t count(OdometryState state) const { return states_[static_cast<std::size_t>(state)]; }
  std::size_t count(RegistrationStatus status) const {
    return statuses_[static_cast<std::size_t>(status)];
  }
  /// Points of all sweeps that found no place on the device (SweepResult::lost_points); 0 is
  /// normal.
  std::size_t lost_points() const { return lost_points_; }
  /// Voxels of all sweeps that too many raw points fell into (SweepResult::crowded_voxels).
  std::size_t crowded_voxels() const { return crowded_voxels_; }
  const std::vector<SweepFailure>& failures() const { return failures_; }
  double distance() const { return distance_; }  ///< m, along the estimated path
  double recorded_seconds() const;               ///< s between the first and the last stamp
  /// HostTimes by their names: "read", which lies beside the others, "read_wait", "host", "wait",
  /// "map", "write", and "total", which is what a sweep took.
  const std::array<StageTimes, 7>& host_stages() const { return host_; }
  /// Preintegration and the sliding graph, a part of "host"; the sweeps that the IMU was fused in.
  const StageTimes& inertial_stage() const { return inertial_times_; }
  /// In the order in which the device ran them, then "total", their sum; empty unless profiled.
  const std::vector<StageTimes>& device_stages() const { return device_; }
  /// What the device was given to do for each sweep.
  const std::vector<engine::RecordedWork>& device_work() const { return work_; }

 private:
  void add_device_times(const std::vector<StageTime>& stages);

  Config config_;
  InertialStatistics inertial_;
  VelocityFusionStatistics velocity_;
  ShareStatistics shares_;
  LeftOut left_out_;
  RunAssessor assessor_;
  MovedByLoops moved_by_loops_;
  std::size_t sweeps_ = 0;
  std::size_t first_index_ = 0;
  std::size_t last_index_ = 0;
  std::size_t longest_missing_ = 0;
  std::size_t deskewed_ = 0;
  std::size_t keyframes_ = 0;
  std::size_t lost_points_ = 0;
  std::size_t crowded_voxels_ = 0;
  std::array<std::size_t, 4> states_{};
  std::array<std::size_t, 7> statuses_{};
  std::vector<SweepFailure> failures_;
  double distance_ = 0.0;
  Eigen::Vector3d coordinate_offset_ = Eigen::Vector3d::Zero();
  std::optional<StampedPose> first_;
  StampedPose last_;
  std::array<StageTimes, 7> host_{StageTimes{"read", {}}, StageTimes{"read_wait", {}},
                                  StageTimes{"host", {}}, StageTimes{"wait", {}},
                                  StageTimes{"map", {}},  StageTimes{"write", {}},
                                  StageTimes{"total", {}}};
  StageTimes inertial_times_{"imu and graph", {}};
  std::vector<StageTimes> device_;
  std::vector<engine::RecordedWork> work_;
};

/// Every value of the two enumerations, in their order.
inline constexpr std::array kOdometryStates{OdometryState::initializing, OdometryState::tracking,
                                            OdometryState::coasting, OdometryState::restarted};
inline constexpr std::array kRegistrationStatuses{
    RegistrationStatus::converged,      RegistrationStatus::degenerate,
    RegistrationStatus::not_converged,  RegistrationStatus::too_little_overlap,
    RegistrationStatus::too_few_points, RegistrationStatus::diverged,
    RegistrationStatus::doubtful};

}  // namespace adit
