// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/gyroscope_integral.hpp"

#include <algorithm>

#include "slam/nav_state.hpp"

namespace adit {
namespace {

constexpr double kLongestGap = 0.1;  // s between samples; over longer ones nothing is integrated

}  // namespace

GyroscopeIntegral::GyroscopeIntegral(std::span<const ImuSample> samples, Nanoseconds origin) {
  for (const ImuSample& sample : samples) {
    const double time = seconds(sample.stamp - origin);
    if (!times_.empty() && time <= times_.back()) {
      continue;  // repeated, or out of order
    }
    Eigen::Vector3d integral = Eigen::Vector3d::Zero();
    if (!times_.empty()) {
      const double step = time - times_.back();
      integral = integrals_.back() + 0.5 * step * (rates_.back() + sample.angular_velocity);
      if (step > kLongestGap) {
        gaps_.emplace_back(times_.back(), time);
      }
    }
    times_.push_back(time);
    rates_.push_back(sample.angular_velocity);
    integrals_.push_back(integral);
  }
}

bool GyroscopeIntegral::covers(double begin, double end) const {
  return times_.size() > 1 && begin >= times_.front() && end <= times_.back() &&
         std::ranges::none_of(
             gaps_, [&](const auto& gap) { return gap.first < end && gap.second > begin; });
}

Eigen::Vector3d GyroscopeIntegral::at(double time) const {
  const std::size_t i = before(time);
  const double step = time - times_[i];
  return integrals_[i] + step * 0.5 * (rates_[i] + rate(time));
}

Eigen::Vector3d GyroscopeIntegral::rate(double time) const {
  const std::size_t i = before(time);
  const double part = (time - times_[i]) / (times_[i + 1] - times_[i]);
  return rates_[i] + part * (rates_[i + 1] - rates_[i]);
}

std::size_t GyroscopeIntegral::before(double time) const {
  const auto above = std::upper_bound(times_.begin() + 1, times_.end() - 1, time);
  return static_cast<std::size_t>(above - times_.begin()) - 1;
}

}  // namespace adit
