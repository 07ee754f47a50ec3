// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/inertial_statistics.hpp"

#include <cstdio>
#include <numeric>

#include <nlohmann/json.hpp>

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kFewestComparisons = 20;

ordered_json json_of(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

ordered_json json_of(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

}  // namespace

void InertialStatistics::add(std::size_t sweep, const InertialReport& report) {
  ++states_[static_cast<std::size_t>(report.state)];
  if (!report.event.empty()) {
    changes_.push_back({.sweep = sweep, .state = report.state, .reason = report.event});
  }
  hindrance_ = report.hindrance;
  compared_ += report.compared ? 1 : 0;
  better_turns_ += report.better_turn ? 1 : 0;
  better_travels_ += report.better_travel ? 1 : 0;
  nis_ += report.innovation.nis;
  degrees_ += static_cast<std::size_t>(report.innovation.degrees);
  last_ = report.nav ? report.nav : last_;
  gravity_ = report.gravity_map.norm() > 0.0 ? report.gravity_map : gravity_;
}

std::size_t InertialStatistics::readings() const {
  return std::accumulate(arrivals_.begin(), arrivals_.end(), std::size_t{0});
}

std::optional<double> InertialStatistics::share(std::size_t better) const {
  return compared_ < kFewestComparisons
             ? std::nullopt
             : std::optional(static_cast<double>(better) / static_cast<double>(compared_));
}

ordered_json InertialStatistics::to_json() const {
  ordered_json json;
  json["readings"] = readings();
  for (const ImuArrival arrival :
       {ImuArrival::inserted, ImuArrival::duplicate, ImuArrival::too_late, ImuArrival::restarted,
        ImuArrival::not_finite}) {
    json["irregular"][std::string(to_string(arrival))] = count(arrival);
  }
  for (const InertialState state :
       {InertialState::absent, InertialState::starting, InertialState::fused, InertialState::lost,
        InertialState::refused}) {
    json["sweeps"][std::string(to_string(state))] = count(state);
  }
  json["changes"] = ordered_json::array();
  for (const Change& change : changes_) {
    json["changes"].push_back(
        {{"sweep", change.sweep}, {"state", to_string(change.state)}, {"reason", change.reason}});
  }
  json["hindrance"] = hindrance_;
  json["better_than_constant_velocity"] = {{"rotation", json_of(better_turns())},
                                           {"translation", json_of(better_travels())}};
  json["innovation_squared_per_degree"] =
      degrees_ > 0 ? ordered_json(nis_ / static_cast<double>(degrees_)) : ordered_json();
  if (last_) {
    json["gravity_m_per_s2"] = json_of(gravity_);
    json["gyro_bias_rad_per_s"] = json_of(last_->bias.gyro);
    json["accel_bias_m_per_s2"] = json_of(last_->bias.accel);
  }
  return json;
}

std::string InertialStatistics::text() const {
  const std::size_t sweeps = std::accumulate(states_.begin(), states_.end(), std::size_t{0});
  std::string text = std::to_string(count(InertialState::fused)) + " of " + std::to_string(sweeps) +
                     " sweeps fused";
  if (const auto turns = better_turns()) {
    char share[100];
    std::snprintf(share, sizeof share, ", rotation better than constant velocity in %.0f %%",
                  100.0 * *turns);
    text += share;
    text += *turns < 0.5 ? " only: check imu.T_imu_lidar and the clocks (adit inspect)" : "";
  }
  if (count(InertialState::fused) < sweeps && !changes_.empty() &&
      changes_.back().state != InertialState::fused) {
    text += "; " + std::string(to_string(changes_.back().state)) + ": " + changes_.back().reason;
  }
  return hindrance_.empty() ? text : text + "; not started: " + hindrance_;
}

}  // namespace adit
