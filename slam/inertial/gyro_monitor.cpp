// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/gyro_monitor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/nav_state.hpp"
#include "adit/slam/inertial/gyroscope_integral.hpp"

namespace adit {
namespace {

constexpr size_t kFewestTurns = 30;
constexpr size_t kMostTurns = 150;
constexpr int kBetweenChecks = 20;
constexpr double kLongestTurn = 0.35;  // s; over longer ones the rotation vector is no integral
constexpr double kMostOffset = 0.3;    // s
constexpr Nanoseconds kKept = std::chrono::seconds(1);       // samples before the first turn
constexpr Nanoseconds kMostKept = std::chrono::seconds(60);  // though no turns come
// Less turning than this, root mean square, tells nothing. rad a turn
constexpr double kLively = 0.008;
constexpr double kStill = 0.02;                 // share of the sweeps' turns: a constant gyroscope
constexpr double kOtherUnit = 2.0;              // times as much, or as little
constexpr double kHarmlessMisalignment = 0.09;  // rad
constexpr double kFarOffTurns = 5.0;            // times the median distance from the gyroscope's
constexpr double kFewWrong = 0.1;               // share of the turns

/// Root mean square of turns about their mean, rad.
double spread(const std::vector<Eigen::Vector3d>& turns) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& turn : turns) {
    mean += turn / static_cast<double>(turns.size());
  }
  double squares = 0.0;
  for (const Eigen::Vector3d& turn : turns) {
    squares += (turn - mean).squaredNorm();
  }
  return turns.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(turns.size()));
}

/// How much a gyroscope's mean rates vary over such intervals: its spread, rad.
double gyro_spread(std::span<const RotationInterval> turns, std::span<const ImuSample> samples) {
  std::vector<Eigen::Vector3d> rotations;
  for (const RotationInterval& turn : turns) {
    const auto begin = std::ranges::lower_bound(samples, turn.begin, {}, &ImuSample::stamp);
    const auto end = std::ranges::lower_bound(samples, turn.end, {}, &ImuSample::stamp);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (auto sample = begin; sample != end; ++sample) {
      sum += sample->angular_velocity;
    }
    if (begin != end) {
      const double duration = seconds(turn.end - turn.begin);
      rotations.push_back(duration / static_cast<double>(end - begin) * sum);
    }
  }
  return spread(rotations);
}

/// The turns that a gyroscope can be held against, whatever its offset.
std::vector<RotationInterval> told_turns(std::span<const RotationInterval> turns,
                                         std::span<const ImuSample> samples,
                                         std::span<const Nanoseconds> saturated) {
  std::vector<RotationInterval> told = covered_rotations(turns, samples, kMostOffset);
  std::erase_if(told, [&](const RotationInterval& turn) {
    const auto first = std::ranges::lower_bound(saturated, turn.begin - nanoseconds(kMostOffset));
    return first != saturated.end() &&
           *first <= turn.end + nanoseconds(turn.mean_over + kMostOffset);
  });
  return told;
}

/// Without the few that are far off a gyroscope as it is thought to be: sweeps that were aligned
/// wrongly, for a while, are no reason to doubt it. All of them where they are more than a few.
std::vector<RotationInterval> without_few_wrong(const std::vector<RotationInterval>& turns,
                                                std::span<const ImuSample> samples,
                                                const GyroExpectation& expected) {
  const Nanoseconds origin = turns.front().begin;
  const GyroscopeIntegral integral(samples, origin);
  std::vector<Eigen::Vector3d> off;
  for (const RotationInterval& turn : turns) {
    const double begin = seconds(turn.begin - origin) + expected.offset;
    const double end = seconds(turn.end - origin) + expected.offset;
    const Eigen::Vector3d measured =
        integral.angle(end, turn.mean_over) - integral.angle(begin, turn.mean_over);
    off.push_back(turn.rotation - expected.R_lidar_imu * measured);
  }
  const auto median = [&](const auto& value_of) {
    std::vector<double> values;
    std::ranges::transform(off, std::back_inserter(values), value_of);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
  };
  Eigen::Vector3d usual;
  for (int k = 0; k < 3; ++k) {
    usual[k] = median([&](const Eigen::Vector3d& one) { return one[k]; });
  }
  const auto distance = [&](const Eigen::Vector3d& one) { return (one - usual).norm(); };
  const double most = kFarOffTurns * median(distance);
  std::vector<RotationInterval> kept;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (distance(off[i]) <= most) {
      kept.push_back(turns[i]);
    }
  }
  const bool few = static_cast<double>(turns.size() - kept.size()) <=
                   kFewWrong * static_cast<double>(turns.size());
  return few ? kept : turns;
}

GyroCheck checked(const std::vector<RotationInterval>& turns, std::span<const ImuSample> samples,
                  const GyroExpectation& expected) {
  std::vector<Eigen::Vector3d> rotations;
  for (const RotationInterval& turn : turns) {
    rotations.push_back(turn.rotation);
  }
  const double lively = spread(rotations);
  GyroCheck result{.turns = turns.size(), .configured_offset = expected.configured};
  if (turns.size() < kLeastRotations || lively < kLively) {
    return result;
  }
  result.factor = gyro_spread(turns, samples) / lively;
  if (result.factor < kStill) {
    result.fault = GyroFault::constant;
    return result;
  }
  result.comparison = compare_rotations(turns, samples, expected.R_lidar_imu, kMostOffset);
  if (!result.comparison) {
    // With less turning than theirs it is the sweeps' turns that are noise.
    result.fault = result.factor < 1.0 / kOtherUnit ? GyroFault::none : GyroFault::unrelated;
  } else if (result.factor > kOtherUnit || result.factor < 1.0 / kOtherUnit) {
    result.fault = GyroFault::unit;
  } else if (is_off_scale(*result.comparison)) {
    result.fault = GyroFault::scale;
  } else if (std::abs(result.comparison->offset - expected.offset) >
             expected.tolerance + kSureSigmas * result.comparison->offset_sigma) {
    result.fault = GyroFault::clock;
  } else if (result.comparison->misalignment >
             kHarmlessMisalignment + kSureSigmas * known_mounting_sigma(*result.comparison)) {
    result.fault = GyroFault::mounting;
  }
  return result;
}

}  // namespace

std::string_view to_string(GyroFault fault) {
  switch (fault) {
    case GyroFault::none:
      return "none";
    case GyroFault::constant:
      return "constant";
    case GyroFault::unrelated:
      return "unrelated";
    case GyroFault::unit:
      return "unit";
    case GyroFault::scale:
      return "scale";
    case GyroFault::clock:
      return "clock";
    case GyroFault::mounting:
      return "mounting";
  }
  return "unknown";
}

void GyroMonitor::add(const ImuSample& sample) {
  if (samples_.empty() || sample.stamp > samples_.back().stamp) {
    samples_.push_back(sample);
    while (sample.stamp - samples_.front().stamp > kMostKept) {
      samples_.pop_front();
    }
  } else if (samples_.back().stamp - sample.stamp > std::chrono::seconds(1)) {
    *this = {};  // the clock was set back
  }
}

void GyroMonitor::add(const StampedPose& alignment, const SweepMotion* deskewed) {
  MeanAttitude mean{.stamp = alignment.stamp, .R_world_sensor = alignment.pose.linear()};
  if (deskewed != nullptr) {
    mean.span = deskewed->last - deskewed->first;
    mean.R_world_sensor = alignment.pose.linear() * so3_exp(mean_turn(*deskewed));
  }
  if (last_ && mean.stamp <= last_->stamp) {
    turns_.clear();
  } else if (last_ && seconds(mean.stamp - last_->stamp) < kLongestTurn) {
    if (const std::optional<RotationInterval> turn = turn_between(*last_, mean)) {
      turns_.push_back(*turn);
      ++unchecked_;
    }
  }
  last_ = mean;
  if (turns_.size() > kMostTurns) {
    turns_.pop_front();
  }
  const Nanoseconds oldest = (turns_.empty() ? alignment.stamp : turns_.front().begin) - kKept;
  while (!samples_.empty() && samples_.front().stamp < oldest) {
    samples_.pop_front();
  }
}

std::optional<GyroCheck> GyroMonitor::check(const GyroExpectation& expected) {
  if (turns_.size() < kFewestTurns || unchecked_ < kBetweenChecks) {
    return std::nullopt;
  }
  unchecked_ = 0;
  const std::vector<ImuSample> samples(samples_.begin(), samples_.end());
  const std::vector<RotationInterval> turns =
      told_turns(std::vector(turns_.begin(), turns_.end()), samples, expected.saturated);
  const GyroCheck found = checked(turns, samples, expected);
  const bool late =
      found.comparison && std::abs(found.comparison->offset - expected.offset) > expected.tolerance;
  return found.fault == GyroFault::none && !late
             ? found
             : checked(without_few_wrong(turns, samples, expected), samples, expected);
}

}  // namespace adit
