// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/velocity_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr double kStandsStill = 0.1;  // share of the speed
constexpr double kOpposite = 0.9 * std::numbers::pi;
constexpr double kTurned = 0.25;         // rad; a mounting that is off by less is estimated
constexpr double kWellExplained = 0.25;  // share of the speed that remains at most
// Of tyres: their radius changes by that with wear, load and pressure.
constexpr double kOddScale = 0.03;
constexpr double kKilometresAnHour = 1.0 / 3.6;

constexpr std::array kSources = {VelocitySource::sensor, VelocitySource::doppler};

}  // namespace

std::string describe(const VelocityComparison& found) {
  if (found.measured_speed < kStandsStill * found.speed) {
    return fmt::format("it stays near zero ({:.2f} m/s) while the sensor moves at {:.2f} m/s",
                       found.measured_speed, found.speed);
  }
  if (found.left > kWellExplained * found.speed) {
    return fmt::format(
        "{:.2f} of {:.2f} m/s remain whatever its scale and mounting: is it late "
        "(velocity.time_offset), or not of this body?",
        found.left, found.speed);
  }
  if (found.turn > kOpposite) {
    return "it has the opposite sign (velocity.T_lidar_sensor)";
  }
  if (found.turn > kTurned) {
    return fmt::format(
        "its axes are turned by {:.0f} degrees: is its mounting right (velocity.T_lidar_sensor)?",
        kDegreesPerRadian * found.turn);
  }
  const bool in_kilometres = std::abs(found.scale / kKilometresAnHour - 1.0) < 0.1;
  return fmt::format("it reads {:.2f} times the velocity{}", 1.0 / found.scale,
                     in_kilometres ? ": is it in km/h?" : "");
}

void VelocityFusionStatistics::add(const SweepResult& result) {
  for (const VelocityReport& report : result.inertial.velocities) {
    Source& source = sources_[static_cast<std::size_t>(report.source)];
    ++source.sweeps;
    if (report.refused) {
      ++source.refused;
      source.contradiction = report.comparison;
    } else if (report.fused()) {
      ++source.fused;
      source.nis += report.innovation.nis;
      source.slips += report.slips ? 1U : 0U;
    }
  }
  moving_points_ += static_cast<std::size_t>(result.moving_points);
  if (result.inertial.nav) {
    calibration_ = result.inertial.nav->velocity;
    calibration_sigma_ =
        result.inertial.nav_covariance.diagonal().segment<3>(kScaleAt).cwiseMax(0.0).cwiseSqrt();
  }
}

bool VelocityFusionStatistics::any() const {
  return std::ranges::any_of(sources_, [](const Source& one) { return one.sweeps > 0; });
}

// A scale is odd where it is off by more than two of its own standard deviations and by more than a
// tyre's wear and pressure explain.
std::string VelocityFusionStatistics::remark(VelocitySource which) const {
  const Source& one = source(which);
  if (one.contradiction) {
    return "refused: " + describe(*one.contradiction);
  }
  std::string text;
  const double scale = calibration_.scale;
  if (which == VelocitySource::sensor && one.fused > 0 && std::abs(scale) > kOddScale &&
      std::abs(scale) > 2.0 * calibration_sigma_[0]) {
    text =
        fmt::format("it reads {:.3f} times the velocity, which is corrected", 1.0 / (1.0 + scale));
  }
  if (one.slips > 0) {
    text += text.empty() ? "" : "; ";
    text +=
        fmt::format("it deviates for a while (slip?) in {} sweeps, which count less", one.slips);
  }
  return text;
}

std::vector<SourceWorth> VelocityFusionStatistics::sources(const Config& config,
                                                           const ShareStatistics& shares) const {
  std::vector<SourceWorth> sources;
  for (const VelocitySource which : kSources) {
    const Source& one = source(which);
    if (one.sweeps == 0) {
      continue;
    }
    const bool is_sensor = which == VelocitySource::sensor;
    sources.push_back(
        {.name = is_sensor ? "velocity" : "doppler",
         .topic = is_sensor ? config.recording.velocity_topic.value_or("") : "",
         .unit = "sweeps",
         .used = one.fused,
         .refused = one.refused,
         .left_out = one.sweeps - one.fused - one.refused,
         .remark = remark(which),
         .innovation_squared = one.fused > 0
                                   ? std::optional(one.nis / (3.0 * static_cast<double>(one.fused)))
                                   : std::nullopt,
         .shares = shares.of(is_sensor ? MotionSource::velocity : MotionSource::doppler)});
  }
  return sources;
}

ordered_json VelocityFusionStatistics::to_json() const {
  ordered_json json = ordered_json::object();
  for (const VelocitySource which : kSources) {
    const Source& one = source(which);
    if (one.sweeps == 0) {
      continue;
    }
    ordered_json& of = json[std::string(to_string(which))];
    of = {{"sweeps", one.sweeps},
          {"fused", one.fused},
          {"refused", one.refused},
          {"slipping", one.slips},
          {"innovation_squared_per_degree",
           one.fused > 0 ? ordered_json(one.nis / (3.0 * static_cast<double>(one.fused)))
                         : ordered_json()},
          {"why_refused",
           one.contradiction ? ordered_json(describe(*one.contradiction)) : ordered_json()}};
    if (which == VelocitySource::sensor) {
      of["scale"] = 1.0 + calibration_.scale;
      of["scale_sigma"] = calibration_sigma_[0];
      of["turn_rad"] = {calibration_.turn[0], calibration_.turn[1]};
      of["turn_sigma_rad"] = {calibration_sigma_[1], calibration_sigma_[2]};
    } else {
      of["moving_points"] = moving_points_;
    }
  }
  return json;
}

std::vector<std::string> VelocityFusionStatistics::text() const {
  std::vector<std::string> lines;
  for (const VelocitySource which : kSources) {
    const Source& one = source(which);
    if (one.sweeps == 0) {
      continue;
    }
    std::string line = which == VelocitySource::sensor ? "sensor: " : "Doppler: ";
    line += fmt::format("{} of {} sweeps fused", one.fused, one.sweeps);
    if (which == VelocitySource::sensor && one.fused > 0) {
      line += fmt::format(", scale {:.3f} (+- {:.3f}), turned by {:.1f} and {:.1f} degrees",
                          1.0 + calibration_.scale, 2.0 * calibration_sigma_[0],
                          kDegreesPerRadian * calibration_.turn[0],
                          kDegreesPerRadian * calibration_.turn[1]);
    }
    if (moving_points_ > 0 && which == VelocitySource::doppler) {
      line += fmt::format(", {} moving points left out", moving_points_);
    }
    if (const std::string odd = remark(which); !odd.empty()) {
      line += "; " + odd;
    }
    lines.push_back(line);
  }
  return lines;
}

}  // namespace adit
