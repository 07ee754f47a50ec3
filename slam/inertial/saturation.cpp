// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/saturation.hpp"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr int kRepeats = 3;
constexpr double kLeastRate = 1.0;      // rad/s: no range ends below
constexpr double kLeastOfUsual = 1.15;  // times gravity: nor below that, nor rests there
constexpr double kForgetting = 0.002;   // share of the usual acceleration, a reading

}  // namespace

void SaturationWatch::Triad::add(const Eigen::Vector3d& value,
                                 const std::array<Nanoseconds, 3>& stamps, double least,
                                 bool stuck) {
  const double size = value.cwiseAbs().maxCoeff();
  if (size > limit) {
    limit = 0.0;  // it was none
    saturated.clear();
  }
  greatest = std::max(greatest, size);
  for (int i = 0; i < 3; ++i) {
    int& same = repeats[static_cast<std::size_t>(i)];
    same = !stuck && value(i) == last(i) ? same + 1 : 1;
    if (limit == 0.0 && same == kRepeats && std::abs(value(i)) == greatest && greatest >= least) {
      limit = greatest;
      saturated.assign(stamps.begin(), stamps.end() - 1);
    }
  }
  if (limit > 0.0 && size == limit) {
    saturated.push_back(stamps.back());
  }
  last = value;
}

void SaturationWatch::add(const ImuSample& sample) {
  const double length = sample.linear_acceleration.norm();
  usual_ += (usual_ == 0.0 ? 1.0 : kForgetting) * (length - usual_);
  const bool stuck = sample.angular_velocity == gyroscope_.last &&
                     sample.linear_acceleration == accelerometer_.last;
  stamps_ = {stamps_[1], stamps_[2], sample.stamp};
  gyroscope_.add(sample.angular_velocity, stamps_, kLeastRate, stuck);
  accelerometer_.add(sample.linear_acceleration, stamps_, kLeastOfUsual * usual_, stuck);
}

std::optional<Saturation> SaturationWatch::between(Nanoseconds begin, Nanoseconds end) const {
  for (const Triad* triad : {&gyroscope_, &accelerometer_}) {
    const auto count = std::ranges::count_if(
        triad->saturated, [&](Nanoseconds stamp) { return stamp > begin && stamp <= end; });
    if (count > 0) {
      return Saturation{.gyroscope = triad == &gyroscope_,
                        .readings = static_cast<std::size_t>(count),
                        .limit = triad->limit};
    }
  }
  return std::nullopt;
}

void SaturationWatch::forget_before(Nanoseconds stamp) {
  for (Triad* triad : {&gyroscope_, &accelerometer_}) {
    while (!triad->saturated.empty() && triad->saturated.front() < stamp) {
      triad->saturated.pop_front();
    }
  }
}

void SaturationWatch::shift(Nanoseconds by) {
  for (Triad* triad : {&gyroscope_, &accelerometer_}) {
    for (Nanoseconds& stamp : triad->saturated) {
      stamp += by;
    }
  }
}

}  // namespace adit
