// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/gyroscope_integral.hpp"

#include <algorithm>
#include <chrono>

namespace adit {
namespace {

constexpr double kLongestGap = 0.1;  // s between samples; over longer ones nothing is integrated

}  // namespace

GyroscopeIntegral::GyroscopeIntegral(std::span<const ImuSample> samples, Nanoseconds origin) {
  for (const ImuSample& sample : samples) {
    const double time = seconds(sample.stamp - origin);
    if (!times_.empty() && time <= times_.back()) {
      continue;
    }
    Eigen::Vector3d angle = Eigen::Vector3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    if (!times_.empty()) {
      const double step = time - times_.back();
      angle = angles_.back() + 0.5 * step * (rates_.back() + sample.angular_velocity);
      sum = sums_.back() + step * angles_.back() +
            step * step * (rates_.back() / 3.0 + sample.angular_velocity / 6.0);
      if (step > kLongestGap) {
        gaps_.emplace_back(times_.back(), time);
      }
    }
    times_.push_back(time);
    rates_.push_back(sample.angular_velocity);
    angles_.push_back(angle);
    sums_.push_back(sum);
  }
}

bool GyroscopeIntegral::covers(double begin, double end) const {
  return times_.size() > 1 && begin >= times_.front() && end <= times_.back() &&
         std::ranges::none_of(
             gaps_, [&](const auto& gap) { return gap.first < end && gap.second > begin; });
}

std::size_t GyroscopeIntegral::before(double time) const {
  const auto above = std::upper_bound(times_.begin() + 1, times_.end() - 1, time);
  return static_cast<std::size_t>(above - times_.begin()) - 1;
}

Eigen::Vector3d GyroscopeIntegral::rate(double time) const {
  const std::size_t i = before(time);
  const double part = (time - times_[i]) / (times_[i + 1] - times_[i]);
  return rates_[i] + part * (rates_[i + 1] - rates_[i]);
}

Eigen::Vector3d GyroscopeIntegral::sum(double time) const {
  const std::size_t i = before(time);
  const double step = time - times_[i];
  return sums_[i] + step * angles_[i] + step * step * (rates_[i] / 3.0 + rate(time) / 6.0);
}

Eigen::Vector3d GyroscopeIntegral::angle(double time, double span) const {
  if (span > 0.0) {
    return (sum(time + span) - sum(time)) / span;
  }
  const std::size_t i = before(time);
  return angles_[i] + 0.5 * (time - times_[i]) * (rates_[i] + rate(time));
}

Eigen::Vector3d GyroscopeIntegral::angle_rate(double time, double span) const {
  return span > 0.0 ? Eigen::Vector3d((angle(time + span) - angle(time)) / span) : rate(time);
}

}  // namespace adit
