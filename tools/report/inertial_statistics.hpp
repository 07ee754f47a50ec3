// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run tells of its inertial sensor.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/fusion/inertial_tracker.hpp"
#include "adit/slam/inertial/imu_buffer.hpp"

namespace adit {

/// Adds up readings and sweeps.
class InertialStatistics {
 public:
  /// A change of state, and why.
  struct Change {
    std::size_t sweep = 0;  ///< in the recording, counted from 0
    InertialState state = InertialState::absent;
    std::string reason;
  };

  void add(ImuArrival arrival) { ++arrivals_[static_cast<std::size_t>(arrival)]; }
  void add(std::size_t sweep, const InertialReport& report);

  bool any() const { return readings() > 0; }
  std::size_t readings() const;
  std::size_t count(InertialState state) const { return states_[static_cast<std::size_t>(state)]; }
  std::size_t count(ImuArrival arrival) const {
    return arrivals_[static_cast<std::size_t>(arrival)];
  }
  const std::vector<Change>& changes() const { return changes_; }
  /// After the last sweep.
  InertialState last_state() const { return last_state_; }
  /// For people, why it was not fused in the end; empty where it was, or nothing is known.
  std::string why_not_fused() const;
  /// Share of the compared sweeps whose rotation (or translation) the inertial prediction was
  /// nearer to than constant velocity. None before 20 comparisons.
  std::optional<double> better_turns() const { return share(better_turns_); }
  std::optional<double> better_travels() const { return share(better_travels_); }

  /// The "imu" of summary.json.
  nlohmann::ordered_json to_json() const;
  /// One line for people, without its end.
  std::string text() const;

 private:
  std::optional<double> share(std::size_t better) const;

  std::array<std::size_t, kImuArrivals> arrivals_{};
  std::array<std::size_t, 5> states_{};
  std::vector<Change> changes_;
  std::string hindrance_;
  InertialState last_state_ = InertialState::absent;
  std::size_t compared_ = 0;
  std::size_t better_turns_ = 0;
  std::size_t better_travels_ = 0;
  double nis_ = 0.0;
  std::size_t degrees_ = 0;
  std::optional<NavState> last_;
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
  std::optional<RotationComparison> comparison_;
  std::size_t bridged_ = 0;   ///< sweeps over gaps in the readings
  double longest_gap_ = 0.0;  ///< s, of these
  double clock_offset_ = 0.0;
  Eigen::Isometry3d T_imu_lidar_ = Eigen::Isometry3d::Identity();
};

}  // namespace adit
