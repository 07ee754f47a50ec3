// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "adit/slam/inertial/imu_rest.hpp"
#include "adit/slam/inertial/imu_start.hpp"

namespace adit {
namespace {

constexpr double kShortest = 0.5;  // s of readings
constexpr size_t kFewest = 20;     // readings
// How far the means of the two halves may be apart.
constexpr double kDriftGyro = 0.01;  // rad/s
constexpr double kDriftAccel = 0.1;  // m/s²
constexpr double kGravityTolerance = 0.5;
constexpr double kLeastScale = 0.7;      // less of gravity is no error of scale but another unit
constexpr double kAccelBiasSigma = 0.1;  // m/s², across gravity
// Spikes among readings at rest: so many times as far from their median as half of all are, and no
// more than this share.
constexpr double kFarFromOthers = 10.0;
constexpr double kFewSpikes = 0.1;

ImuStart refused(ImuStartStatus status, const ImuStartReason& reason) {
  ImuStart start;
  start.status = status;
  start.reason = reason;
  return start;
}

/// Without the few that are far from all others: the first spikes come before it is known what is
/// usual, and pass. All of them where they are more than a few.
std::vector<ImuSample> without_spikes(std::span<const ImuSample> samples) {
  const auto median = [&](const auto& value_of) {
    std::vector<double> values;
    std::ranges::transform(samples, std::back_inserter(values), value_of);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
  };
  Eigen::Vector3d gyro;
  Eigen::Vector3d accel;
  for (int k = 0; k < 3; ++k) {
    gyro[k] = median([&](const ImuSample& one) { return one.angular_velocity[k]; });
    accel[k] = median([&](const ImuSample& one) { return one.linear_acceleration[k]; });
  }
  const auto turned = [&](const ImuSample& one) { return (one.angular_velocity - gyro).norm(); };
  const auto pushed = [&](const ImuSample& one) {
    return (one.linear_acceleration - accel).norm();
  };
  const double most_turned = kFarFromOthers * median(turned);
  const double most_pushed = kFarFromOthers * median(pushed);
  std::vector<ImuSample> kept;
  std::ranges::copy_if(samples, std::back_inserter(kept), [&](const ImuSample& one) {
    return turned(one) <= most_turned && pushed(one) <= most_pushed;
  });
  const bool few = static_cast<double>(samples.size() - kept.size()) <=
                   kFewSpikes * static_cast<double>(samples.size());
  return few ? kept : std::vector<ImuSample>(samples.begin(), samples.end());
}

}  // namespace

std::string_view to_string(ImuStartStatus status) {
  switch (status) {
    case ImuStartStatus::at_rest:
      return "at rest";
    case ImuStartStatus::in_motion:
      return "in motion";
    case ImuStartStatus::too_short:
      return "too short";
    case ImuStartStatus::not_at_rest:
      return "not at rest";
    case ImuStartStatus::implausible:
      return "implausible";
    case ImuStartStatus::unobserved:
      return "unobserved";
  }
  return "unknown";
}

Eigen::Matrix3d level_attitude(const Eigen::Vector3d& up_body) {
  const Eigen::Vector3d z = up_body.normalized();
  const bool vertical = std::abs(z.x()) > 0.9;
  const Eigen::Vector3d forward = vertical ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d first = (forward - forward.dot(z) * z).normalized();
  Eigen::Matrix3d R_map_body;
  R_map_body.row(vertical ? 1 : 0) = first;
  R_map_body.row(vertical ? 0 : 1) = vertical ? first.cross(z) : z.cross(first);
  R_map_body.row(2) = z;
  return R_map_body;
}

std::vector<ImuSample> with_accel_scale(std::span<const ImuSample> samples, double scale) {
  std::vector<ImuSample> scaled(samples.begin(), samples.end());
  for (ImuSample& sample : scaled) {
    sample.linear_acceleration *= scale;
  }
  return scaled;
}

ImuStart start_at_rest(std::span<const ImuSample> all_samples, const ImuNoise& noise) {
  const std::vector<ImuSample> kept =
      all_samples.empty() ? std::vector<ImuSample>() : without_spikes(all_samples);
  const std::span<const ImuSample> samples(kept);
  const double duration =
      samples.empty() ? 0.0 : seconds(samples.back().stamp - samples.front().stamp);
  if (samples.size() < kFewest || duration < kShortest) {
    return refused(ImuStartStatus::too_short, TooFewReadings{.readings = samples.size(),
                                                             .duration = duration,
                                                             .needed = kFewest,
                                                             .needed_duration = kShortest});
  }
  ReadingStatistics all = statistics_of(samples);
  const double raw_norm = all.accel.norm();
  const double scale = raw_norm > 0.8 && raw_norm < 1.2 ? kStandardGravity : 1.0;
  all.accel *= scale;
  all.accel_deviation *= scale;
  const ReadingStatistics older = statistics_of(samples.first(samples.size() / 2));
  const ReadingStatistics newer = statistics_of(samples.subspan(samples.size() / 2));

  if (all.gyro_deviation > kRestGyro || all.accel_deviation > kRestAccel ||
      (older.gyro - newer.gyro).norm() > kDriftGyro ||
      scale * (older.accel - newer.accel).norm() > kDriftAccel) {
    return refused(ImuStartStatus::not_at_rest, NotAtRest{.gyro = all.gyro_deviation,
                                                          .accel = all.accel_deviation,
                                                          .gyro_limit = kRestGyro,
                                                          .accel_limit = kRestAccel});
  }
  if (all.gyro.norm() > kRestGyroBias) {
    return refused(ImuStartStatus::not_at_rest, SteadyTurn{.rate = all.gyro.norm()});
  }
  const double norm = all.accel.norm();
  if (std::abs(norm - kStandardGravity) > kGravityTolerance) {
    const double off = norm / kStandardGravity;
    const bool scaled = off > kLeastScale && off < 1.0 / kLeastScale;
    return refused(ImuStartStatus::implausible,
                   NoGravityAtRest{.reading = raw_norm,
                                   .scale = scaled ? std::optional(1.0 / off) : std::nullopt});
  }

  ImuStart start;
  start.status = ImuStartStatus::at_rest;
  start.reason = StartedAtRest{.duration = duration, .in_g = scale != 1.0};
  start.accel_scale = scale;
  start.up_body = all.accel.normalized();
  start.bias.gyro = all.gyro;
  start.bias.accel = (norm - kStandardGravity) * start.up_body;
  // An unseen bias of the accelerometer across gravity tilts it.
  start.gravity_sigma = kAccelBiasSigma / kStandardGravity;
  start.velocity_sigma = 0.01;
  start.rest_sigma = std::hypot(start.velocity_sigma / duration, noise.accel / std::sqrt(duration));
  const double white = noise.gyro / std::sqrt(duration);
  start.bias_sigma.gyro.setConstant(std::hypot(white, noise.gyro_walk * std::sqrt(duration)) +
                                    1e-4);
  start.bias_sigma.accel.setConstant(kAccelBiasSigma);
  return start;
}

}  // namespace adit
