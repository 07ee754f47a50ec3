// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/saturation.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace adit {
namespace {

constexpr int kRepeats = 3;
constexpr double kLeastRate = 1.0;      // rad/s: no range ends below
constexpr double kLeastOfUsual = 1.15;  // times gravity: nor below that, nor rests there
constexpr double kForgetting = 0.002;   // of the usual acceleration, a reading

std::string text_of(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::general, 4)
                       .ptr;
  return {buffer.data(), end};
}

}  // namespace

void SaturationWatch::judge(Triad& triad, const Eigen::Vector3d& value, double least, bool stuck,
                            const std::array<Nanoseconds, 2>& before, Nanoseconds stamp) {
  const double size = value.cwiseAbs().maxCoeff();
  if (size > triad.limit) {
    triad.limit = 0.0;  // it was none
    triad.saturated.clear();
  }
  triad.greatest = std::max(triad.greatest, size);
  for (int i = 0; i < 3; ++i) {
    int& repeats = triad.repeats[static_cast<std::size_t>(i)];
    repeats = !stuck && value(i) == triad.last(i) ? repeats + 1 : 1;
    if (triad.limit == 0.0 && repeats == kRepeats && std::abs(value(i)) == triad.greatest &&
        triad.greatest >= least) {
      triad.limit = triad.greatest;
      triad.saturated.assign(before.begin(), before.end());
    }
  }
  if (triad.limit > 0.0 && size == triad.limit) {
    triad.saturated.push_back(stamp);
  }
  triad.last = value;
}

void SaturationWatch::add(const ImuSample& sample) {
  const double length = sample.linear_acceleration.norm();
  usual_ += (usual_ == 0.0 ? 1.0 : kForgetting) * (length - usual_);
  const bool stuck = sample.angular_velocity == gyroscope_.last &&
                     sample.linear_acceleration == accelerometer_.last;
  judge(gyroscope_, sample.angular_velocity, kLeastRate, stuck, before_, sample.stamp);
  judge(accelerometer_, sample.linear_acceleration, kLeastOfUsual * usual_, stuck, before_,
        sample.stamp);
  before_ = {before_[1], sample.stamp};
}

std::string SaturationWatch::evidence(Nanoseconds begin, Nanoseconds end) const {
  const auto within = [&](const Triad& triad) {
    return std::ranges::count_if(triad.saturated,
                                 [&](Nanoseconds stamp) { return stamp > begin && stamp <= end; });
  };
  const auto told = [&](const Triad& triad, const char* name, const char* unit) {
    const auto count = within(triad);
    return std::string("the ") + name + " is saturated: " + std::to_string(count) +
           (count == 1 ? " reading stands at " : " readings stand at ") + text_of(triad.limit) +
           unit + ", the end of its range";
  };
  return within(gyroscope_) > 0       ? told(gyroscope_, "gyroscope", " rad/s")
         : within(accelerometer_) > 0 ? told(accelerometer_, "accelerometer", "")
                                      : "";
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
