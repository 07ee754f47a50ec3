// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/motion_check.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/slam/inertial/gyroscope_integral.hpp"
#include "adit/slam/inertial/reading_gate.hpp"
#include "adit/tools/report/inertial_text.hpp"
#include "adit/tools/topics/clock_watch.hpp"

namespace adit {
namespace {

constexpr double kMostOffset = 0.5;             // s
constexpr double kHarmlessOffset = 0.02;        // s: what distorted sweeps can feign
constexpr double kHarmlessMisalignment = 0.09;  // rad, 5 degrees

/// Calls take(event) for each event that can be read.
template <class Take>
void for_each_event(const Recording& recording, const EventSelection& selection, Take&& take) {
  const auto events = recording.events(selection);
  for (bool more = true; more;) {
    try {
      const std::optional<Event> event = events->next();
      more = event.has_value();
      if (event) {
        take(*event);
      }
    } catch (const InputError&) {
      // reported by who reads all of it
    }
  }
}

/// Whole seconds from a topic's clock to the recorder's; 0 where they agree.
class ClockShift {
 public:
  void add(const Event& event) { clock_.add(event.received, stamp_of(event)); }
  Nanoseconds value() const {
    const double delay = clock_.typical_delay();
    return std::abs(delay) < 1.0 ? Nanoseconds(0)
                                 : std::chrono::seconds(static_cast<int64_t>(std::llround(delay)));
  }

 private:
  ClockWatch clock_;
};

double median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<RotationInterval> rotations_of(const Recording& recording,
                                           const std::function<SweepResult(const Sweep&)>& place,
                                           MotionCheck& check) {
  std::vector<RotationInterval> rotations;
  std::vector<double> intervals;
  ClockShift shift;
  std::optional<MeanAttitude> last;  // tracked
  std::optional<Nanoseconds> last_stamp;
  const EventSelection selection{.topics = {check.pair.sweep_topic},
                                 .begin = check.pair.stretch.begin,
                                 .end = check.pair.stretch.end};
  for_each_event(recording, selection, [&](const Event& event) {
    const Sweep& sweep = std::get<Sweep>(event.value);
    if (last_stamp && sweep.stamp <= *last_stamp) {
      return;
    }
    if (last_stamp) {
      intervals.push_back(seconds(sweep.stamp - *last_stamp));
    }
    last_stamp = sweep.stamp;
    shift.add(event);
    ++check.sweeps;
    const double duration = check.pair.trust_point_times ? duration_of(sweep) : 0.0;
    check.point_times = check.point_times || duration > 0.0;
    const SweepResult result = place(sweep);
    check.mapped.push_back(sweep_record(check.mapped.size(), result));
    // Its pose less the turn to the mean that de-skewing assumed.
    const MeanAttitude mean{
        .stamp = sweep.stamp,
        .span = duration,
        .R_world_sensor = result.T_map_lidar.linear() * so3_exp(result.deskewed_turn)};
    if (result.state != OdometryState::tracking) {
      last = result.state == OdometryState::coasting ? std::nullopt : std::optional(mean);
      return;
    }
    ++check.tracked;
    if (const auto turn = last ? turn_between(*last, mean) : std::nullopt) {
      rotations.push_back(*turn);
    }
    last = mean;
  });
  for (RotationInterval& one : rotations) {
    one.begin += shift.value();
    one.end += shift.value();
  }
  check.period = median(std::move(intervals));
  return rotations;
}

std::vector<ImuSample> gyroscope_of(const Recording& recording, const MotionPair& pair) {
  constexpr Nanoseconds kMargin = std::chrono::seconds(2);
  std::vector<ImuSample> samples;
  ClockShift shift;
  const EventSelection selection{.topics = {pair.imu_topic},
                                 .begin = pair.stretch.begin - kMargin,
                                 .end = pair.stretch.end + kMargin};
  ReadingGate gate({});
  for_each_event(recording, selection, [&](const Event& event) {
    ImuSample sample = std::get<ImuSample>(event.value);
    sample.linear_acceleration.setZero();  // not used here, and none has to be there
    shift.add(event);
    for (const GatedReading& known : gate.pass(sample)) {
      if (!known.dropped) {
        samples.push_back(known.sample);
      }
    }
  });
  for (ImuSample& sample : samples) {
    sample.stamp += shift.value();
  }
  return samples;
}

/// The gyroscope's bias is what its turns and those of the sweeps differ by on average.
std::vector<ComparedTurn> compared_turns(const std::vector<RotationInterval>& rotations,
                                         const std::vector<ImuSample>& gyroscope,
                                         const RotationComparison& found) {
  std::vector<ComparedTurn> turns;
  const GyroscopeIntegral integral(gyroscope, rotations.front().begin);
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  // rad/s, axes of the range sensor
  for (const RotationInterval& one : rotations) {
    const double begin = seconds(one.begin - rotations.front().begin);
    const double end = seconds(one.end - rotations.front().begin);
    if (!integral.covers(begin + found.offset, end + one.mean_over + found.offset)) {
      continue;
    }
    const Eigen::Vector3d turn = integral.angle(end + found.offset, one.mean_over) -
                                 integral.angle(begin + found.offset, one.mean_over);
    turns.push_back({.end = end,
                     .duration = end - begin,
                     .range = one.rotation,
                     .gyroscope = found.R_range_gyro * turn});
    bias += (turns.back().gyroscope - one.rotation) / (end - begin);
  }
  for (ComparedTurn& turn : turns) {
    turn.gyroscope -= turn.duration * bias / static_cast<double>(turns.size());
  }
  return turns;
}

/// Roll, pitch and yaw (degrees, R = Rz Ry Rx), as people give mountings.
std::string angles(const Eigen::Matrix3d& rotation) {
  const double pitch = std::asin(std::clamp(-rotation(2, 0), -1.0, 1.0));
  const double roll = std::atan2(rotation(2, 1), rotation(2, 2));
  const double yaw = std::atan2(rotation(1, 0), rotation(0, 0));
  return fmt::format("roll {:.1f}, pitch {:.1f}, yaw {:.1f} degrees", roll * kDegreesPerRadian,
                     pitch * kDegreesPerRadian, yaw * kDegreesPerRadian);
}

std::string quaternion(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  return fmt::format("qx {:.4f}, qy {:.4f}, qz {:.4f}, qw {:.4f}", q.x(), q.y(), q.z(), q.w());
}

Finding offset_finding(const MotionCheck& check) {
  const RotationComparison& found = *check.comparison;
  const std::string other = check.pair.sweeps.name;
  const std::string text = fmt::format(
      "the same rotation has a time {:.4f} s {} here than on {} (+- {:.4f} s; correlation {:.3f} "
      "over {} sweeps)",
      std::abs(found.offset), found.offset > 0.0 ? "later" : "earlier", other,
      kSureSigmas * found.offset_sigma, found.correlation, check.sweeps);
  const std::string effect = fmt::format(
      "while it turns at 1 rad/s, sweeps are corrected by {:.1f} degrees too much or too little",
      std::abs(found.offset) * kDegreesPerRadian);
  const std::string remedy = fmt::format(
      "Add {:.4f} s to the times of this topic, or synchronise the clocks of the sensors",
      -found.offset);
  return {Severity::problem, "sensor_offset", check.pair.imu.name, text, effect, remedy};
}

Finding mounting_finding(const MotionCheck& check) {
  const RotationComparison& found = *check.comparison;
  const Eigen::Matrix3d& told = *check.pair.R_range_gyro;
  const bool inverted = rotation_angle(told * found.R_range_gyro) <
                        kHarmlessMisalignment + kSureSigmas * known_mounting_sigma(found);
  const std::string hidden = names_of_unobserved_axes(found);
  const std::string text = fmt::format(
      "{} mounts it to the sensor of {} with {}, the motion with {}: {:.1f} degrees apart (+- "
      "{:.1f}){}{}",
      check.pair.told_by, check.pair.sweeps.name, angles(told), angles(found.R_range_gyro),
      found.misalignment * kDegreesPerRadian,
      kSureSigmas * known_mounting_sigma(found) * kDegreesPerRadian,
      hidden.empty() ? "" : ", as far as the motion tells",
      inverted ? "; the transform is the wrong way round" : "");
  return {
      Severity::problem,
      "mounting",
      check.pair.imu.name,
      text,
      "rotations and gravity act about the wrong axes: mapping with this IMU fails at the first "
      "turn",
      std::string(inverted ? "Invert the transform" : "Correct the transform") +
          (hidden.empty() ? "; by the motion the rotation from this IMU to the range sensor is " +
                                quaternion(found.R_range_gyro)
                          : "; the motion does not tell its " + hidden +
                                ": record some seconds in which it turns about every axis")};
}

Finding scale_finding(const MotionCheck& check) {
  const RotationComparison& found = *check.comparison;
  const std::string text = fmt::format(
      "its gyroscope turns {:.3f} (+- {:.3f}) times as much as the sweeps of {}: its scale is off",
      found.scale, kSureScaleSigmas * found.scale_sigma, check.pair.sweeps.name);
  const std::string remedy =
      fmt::format("Set recording.gyroscope_scale = {:.4f}", 1.0 / found.scale);
  return {Severity::problem,
          "gyroscope_scale",
          check.pair.imu.name,
          text,
          "turns are predicted wrongly, or it is left out",
          remedy};
}

}  // namespace

MotionCheck check_motion(const Recording& recording, const MotionPair& pair,
                         const std::function<SweepResult(const Sweep&)>& place) {
  MotionCheck check;
  check.pair = pair;
  const std::vector<RotationInterval> rotations = rotations_of(recording, place, check);
  const std::vector<ImuSample> gyroscope = gyroscope_of(recording, pair);
  check.comparison = compare_rotations(
      rotations, gyroscope, pair.R_range_gyro.value_or(Eigen::Matrix3d::Identity()), kMostOffset);
  if (check.comparison) {
    check.turns = compared_turns(rotations, gyroscope, *check.comparison);
  }
  return check;
}

std::vector<Finding> find_in_motion(const MotionCheck& check) {
  std::vector<Finding> findings;
  if (!check.comparison) {
    return findings;
  }
  const RotationComparison& found = *check.comparison;
  if (is_off_scale(found)) {
    findings.push_back(scale_finding(check));
  }
  // Without times of points a sweep's stamp may be its start, its middle or its end.
  const double hidden = check.point_times ? kHarmlessOffset : 1.1 * check.period;
  if (std::abs(found.offset) > hidden + kSureSigmas * found.offset_sigma) {
    findings.push_back(offset_finding(check));
  }
  if (check.pair.R_range_gyro &&
      found.misalignment > kHarmlessMisalignment + kSureSigmas * known_mounting_sigma(found)) {
    findings.push_back(mounting_finding(check));
  }
  return findings;
}

std::string describe(const MotionCheck& check) {
  if (!check.comparison) {
    return fmt::format(
        "offset and mounting to {}: cannot be told ({} of {} sweeps could be aligned; it must turn "
        "for some seconds)",
        check.pair.sweeps.name, check.tracked, check.sweeps);
  }
  const RotationComparison& found = *check.comparison;
  std::string text =
      fmt::format("offset to {} {:+.4f} s (+- {:.4f}); mounting by the motion: ",
                  check.pair.sweeps.name, found.offset, kSureSigmas * found.offset_sigma) +
      angles(found.R_range_gyro);
  const auto known = std::ranges::count_if(found.mounting_sigma,
                                           [](double sigma) { return std::isfinite(sigma); });
  if (known < 3) {
    text += known == 0 ? " (a guess)" : " (about some axes a guess)";
  }
  return text +
         fmt::format(
             "; it turns {:.3f} (+- {:.3f}) times as much; correlation {:.3f} over {} sweeps",
             found.scale, kSureScaleSigmas * found.scale_sigma, found.correlation, check.sweeps);
}

}  // namespace adit
