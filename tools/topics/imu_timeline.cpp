// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/topics/imu_timeline.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

#include "adit/slam/inertial/imu_rest.hpp"

namespace adit {
namespace {

constexpr double kShortest = 1.0;  // s
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector3d mean(const Eigen::Vector3d& sum, double n) {
  return n > 0.0 ? Eigen::Vector3d(sum / n) : Eigen::Vector3d::Constant(kUnknown);
}

double deviation(const Eigen::Vector3d& sum, double squares, double n) {
  return n > 0.0 ? std::sqrt(std::max(0.0, squares / n - (sum / n).squaredNorm())) : kUnknown;
}

bool is_at_rest(const ImuBin& bin) {
  return bin.turns > 0.0 && bin.rotation().norm() < kRestGyroBias &&
         bin.rotation_deviation() < kRestGyro && bin.acceleration_deviation() < kRestAccel;
}

/// As many bins from `first` on as are at rest together, at least so many as last the shortest
/// time; 0 where these are not.
std::size_t bins_at_rest(const ImuTimeline& timeline, std::size_t first) {
  const std::vector<ImuBin>& bins = timeline.bins();
  const auto fewest =
      static_cast<std::size_t>(std::max(1.0, std::ceil(kShortest / timeline.bin_width() - 1e-9)));
  ImuBin together;
  std::size_t count = 0;
  while (first + count < bins.size() && bins[first + count].samples > 0.0) {
    ImuBin more = together;
    more.add(bins[first + count]);
    if (count + 1 >= fewest && !is_at_rest(more)) {
      break;
    }
    together = more;
    ++count;
  }
  return count >= fewest && is_at_rest(together) ? count : 0;
}

}  // namespace

void ImuBin::add(const ImuBin& other) {
  samples += other.samples;
  turns += other.turns;
  rotation_sum += other.rotation_sum;
  rotation_squares += other.rotation_squares;
  acceleration_sum += other.acceleration_sum;
  acceleration_squares += other.acceleration_squares;
}

Eigen::Vector3d ImuBin::rotation() const {
  return mean(rotation_sum, turns);
}

Eigen::Vector3d ImuBin::acceleration() const {
  return mean(acceleration_sum, samples);
}

double ImuBin::rotation_deviation() const {
  return deviation(rotation_sum, rotation_squares, turns);
}

double ImuBin::acceleration_deviation() const {
  return deviation(acceleration_sum, acceleration_squares, samples);
}

ImuBin one_reading(const ImuSample& sample) {
  ImuBin bin;
  bin.samples = 1.0;
  bin.acceleration_sum = sample.linear_acceleration;
  bin.acceleration_squares = sample.linear_acceleration.squaredNorm();
  if (sample.angular_velocity.allFinite()) {
    bin.turns = 1.0;
    bin.rotation_sum = sample.angular_velocity;
    bin.rotation_squares = sample.angular_velocity.squaredNorm();
  }
  return bin;
}

std::vector<RestStretch> rest_stretches(const ImuTimeline& timeline) {
  std::vector<RestStretch> found;
  for (std::size_t i = 0; i < timeline.bins().size();) {
    const std::size_t count = bins_at_rest(timeline, i);
    if (count == 0) {
      ++i;
      continue;
    }
    ImuBin all;
    for (std::size_t k = i; k < i + count; ++k) {
      all.add(timeline.bins()[k]);
    }
    found.push_back({.begin = timeline.bin_width() * static_cast<double>(i),
                     .end = timeline.bin_width() * static_cast<double>(i + count),
                     .gyro_bias = all.rotation(),
                     .acceleration = all.acceleration()});
    i += count;
  }
  return found;
}

}  // namespace adit
