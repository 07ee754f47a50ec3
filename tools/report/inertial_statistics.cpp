// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/inertial_statistics.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/tools/report/inertial_text.hpp"

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

/// In the lidar's axes; null where the motion does not tell it.
ordered_json json_of(const RotationComparison& found) {
  const Eigen::Quaterniond q(Eigen::Matrix3d(found.R_range_gyro.transpose()));
  ordered_json json = {{"clock_offset_s", found.offset},
                       {"clock_offset_sigma_s", found.offset_sigma},
                       {"correlation", found.correlation},
                       {"rotation_imu_lidar", {q.x(), q.y(), q.z(), q.w()}},
                       {"misalignment_deg", kDegreesPerRadian * found.misalignment}};
  for (const double sigma : found.mounting_sigma) {
    json["rotation_sigma_deg"].push_back(
        std::isfinite(sigma) ? ordered_json(kDegreesPerRadian * sigma) : ordered_json());
  }
  json["rotation_information_per_rad2"] = json_of(found.mounting_information);
  json["not_observed"] = names_of_unobserved_axes(found);
  return json;
}

/// What the readings' gate kept out, for people; empty where that is nothing.
std::string dropped_text(std::size_t spikes, std::size_t impossible, std::size_t not_finite,
                         std::size_t readings) {
  std::string text;
  if (not_finite > 0) {
    text += "; " + std::to_string(not_finite) + (not_finite == 1 ? " reading" : " readings") +
            " with values that are not finite dropped";
  }
  if (spikes > 0) {
    text += "; " + std::to_string(spikes) + (spikes == 1 ? " spike" : " spikes") + " dropped";
  }
  if (impossible > 0) {
    text += "; " + std::to_string(impossible) + " impossible " +
            (impossible == 1 ? "reading" : "readings") +
            " dropped (imu.max_rate, imu.max_acceleration)";
  }
  return text.empty() ? text : text + " of " + std::to_string(readings);
}

std::string text_of(const RotationComparison& found) {
  const std::string text = fmt::format(
      "against the sweeps its clock is {:+.1f} ms off (+- {:.1f}), its mounting {:.1f} degrees (+- "
      "{:.1f}",
      1e3 * found.offset, 1e3 * kSureSigmas * found.offset_sigma,
      kDegreesPerRadian * found.misalignment,
      kDegreesPerRadian * kSureSigmas * known_mounting_sigma(found));
  const std::string hidden = names_of_unobserved_axes(found);
  return text + (hidden.empty() ? ")" : "; the motion does not tell " + hidden + ")");
}

}  // namespace

void InertialStatistics::add(std::size_t sweep, const InertialReport& report) {
  ++states_[static_cast<std::size_t>(report.state)];
  last_state_ = report.state;
  if (report.event) {
    changes_.push_back({.sweep = sweep, .state = report.state, .reason = describe(*report.event)});
  }
  hindrance_ = report.hindrance ? describe(*report.hindrance) : "";
  compared_ += report.compared ? 1 : 0;
  better_turns_ += report.better_turn ? 1 : 0;
  better_travels_ += report.better_travel ? 1 : 0;
  nis_ += report.innovation.nis;
  degrees_ += static_cast<std::size_t>(report.innovation.degrees);
  last_ = report.nav ? report.nav : last_;
  gravity_ = report.gravity_map.norm() > 0.0 ? report.gravity_map : gravity_;
  comparison_ = report.comparison ? report.comparison : comparison_;
  bridged_ += report.bridged_gap > 0.0 ? 1 : 0;
  longest_gap_ = std::max(longest_gap_, report.bridged_gap);
  clock_offset_ = report.clock_offset;
  T_imu_lidar_ = report.T_body_lidar;
}

std::string InertialStatistics::why_not_fused() const {
  if (last_state_ == InertialState::fused) {
    return "";
  }
  const bool told = !changes_.empty() && changes_.back().state != InertialState::fused;
  return told ? changes_.back().reason : hindrance_;
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
        ImuArrival::not_finite, ImuArrival::impossible, ImuArrival::spike}) {
    json["irregular"][std::string(to_string(arrival))] = count(arrival);
  }
  for (const InertialState state :
       {InertialState::absent, InertialState::starting, InertialState::fused, InertialState::lost,
        InertialState::refused}) {
    json["sweeps"][std::string(to_string(state))] = count(state);
  }
  json["gaps_bridged"] = {{"sweeps", bridged_}, {"longest_s", longest_gap_}};
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
  json["clock_offset_taken_off_s"] = clock_offset_;
  const Eigen::Quaterniond used(T_imu_lidar_.linear());
  json["rotation_imu_lidar_used"] = {used.x(), used.y(), used.z(), used.w()};
  json["gyroscope_against_sweeps"] = comparison_ ? json_of(*comparison_) : ordered_json();
  return json;
}

std::string InertialStatistics::text() const {
  const std::size_t sweeps = std::accumulate(states_.begin(), states_.end(), std::size_t{0});
  std::string text = std::to_string(count(InertialState::fused)) + " of " + std::to_string(sweeps) +
                     " sweeps fused";
  if (const auto turns = better_turns()) {
    const std::string share =
        fmt::format(", rotation better than constant velocity in {:.0f} %", 100.0 * *turns);
    text += share;
    text += *turns < 0.5 ? " only: check imu.T_imu_lidar and the clocks (adit inspect)" : "";
  }
  if (comparison_) {
    text += "; " + text_of(*comparison_);
  }
  if (count(InertialState::fused) < sweeps && !changes_.empty() &&
      changes_.back().state != InertialState::fused) {
    text += "; " + std::string(to_string(changes_.back().state)) + ": " + changes_.back().reason;
  }
  if (bridged_ > 0) {
    const std::string gaps =
        fmt::format("; gaps of the readings of up to {:.3f} s bridged, in {} {}", longest_gap_,
                    bridged_, bridged_ == 1 ? "sweep" : "sweeps");
    text += gaps;
  }
  text += dropped_text(count(ImuArrival::spike), count(ImuArrival::impossible),
                       count(ImuArrival::not_finite), readings());
  return hindrance_.empty() ? text : text + "; not started: " + hindrance_;
}

}  // namespace adit
