// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The tracker with alignments that are made up from the truth, and readings that anything can be
// done to.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/fusion/inertial_tracker.hpp"
#include "adit/slam/odometry/motion_model.hpp"
#include "adit/tests/support/simulated_imu.hpp"

namespace adit::test {

inline constexpr double kRate = 200.0;
inline constexpr double kSweep = 0.1;  // s
inline const ImuBias kBias{{0.02, -0.01, 0.015}, {0.05, -0.03, 0.04}};

/// The lidar is not where the IMU is, and looks elsewhere.
inline ImuConfig tracker_config() {
  ImuConfig config;
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()));
  config.T_imu_lidar = {0.1, -0.05, 0.2, q.x(), q.y(), q.z(), q.w()};
  return config;
}

inline Eigen::Isometry3d T_body_lidar() {
  const auto v = *tracker_config().T_imu_lidar;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(v[6], v[3], v[4], v[5]).toRotationMatrix();
  pose.translation() << v[0], v[1], v[2];
  return pose;
}

struct Outcome {
  std::vector<InertialReport> reports;
  std::vector<double> errors;  ///< m, of the lidar's position after each sweep
  /// How measured velocities led to each sweep from the one before, and how far (m) from the truth.
  std::vector<std::optional<MeasuredMotion>> measured;
  std::vector<double> measured_errors;
  double error_after(double time) const {
    const auto from = static_cast<std::ptrdiff_t>(time / kSweep);
    return *std::max_element(errors.begin() + from, errors.end());
  }
  InertialState state_at(double time) const {
    return reports[static_cast<size_t>(time / kSweep)].state;
  }
  /// What happened of that kind, in order of time.
  template <class Cause>
  std::vector<Cause> all() const {
    std::vector<Cause> found;
    for (const InertialReport& report : reports) {
      const auto* cause = report.event ? std::get_if<Cause>(&report.event->cause) : nullptr;
      if (cause != nullptr) {
        found.push_back(*cause);
      }
    }
    return found;
  }
  /// The starts of that kind.
  template <class How>
  std::vector<How> starts() const {
    std::vector<How> found;
    for (const SensorStarted& start : all<SensorStarted>()) {
      if (const auto* how = std::get_if<How>(&start.how)) {
        found.push_back(*how);
      }
    }
    return found;
  }
  /// Those that were reported, at their onset or with what else happened.
  std::vector<Saturation> saturations() const {
    std::vector<Saturation> found = all<Saturation>();
    for (const InertialReport& report : reports) {
      if (report.event && report.event->passing) {
        if (const auto* one = std::get_if<Saturation>(&*report.event->passing)) {
          found.push_back(*one);
        }
      }
    }
    return found;
  }
  /// Events of all sweeps, for a test that fails.
  std::string events() const {
    std::string text;
    for (size_t i = 0; i < reports.size(); ++i) {
      if (const auto& event = reports[i].event) {
        text += std::to_string(i) + ": " + std::string(to_string(event->cause)) + ", " +
                std::string(to_string(reports[i].state)) + "\n";
      }
    }
    return text;
  }
};

/// Changes the readings before they are handed on.
using Fault = std::function<void(std::vector<ImuSample>&)>;

/// What is wrong with sweep i.
struct SweepFault {
  std::function<double(int)> delay{};  ///< s, of its stamp
  std::function<void(int, RegistrationResult&)> alignment{};
  std::function<bool(int)> unaligned{};  ///< it was empty, or matched nothing
};

/// What a sensor of velocities at the IMU, in its axes, reads at a time (s), where the body's
/// velocity is so much (m/s, body axes). Empty: there is none.
using VelocityReading = std::function<Eigen::Vector3d(double, const Eigen::Vector3d&)>;
inline constexpr double kVelocityRate = 50.0;  // Hz

inline VelocityConfig velocity_config() {
  return {.T_lidar_sensor = numbers_of(T_body_lidar().inverse())};
}

/// Ten seconds by hand, alignments good to 2 mm and 0.3 mrad.
inline Outcome run_tracker(const Fault& fault, double duration = 10.0,
                           const ImuConfig& imu = tracker_config(),
                           const WavyMotion& motion = hand_held_motion(),
                           const SweepFault& sweeps = {}, const VelocityReading& velocity = {}) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<ImuSample> samples = readings(motion, -0.1, duration + 0.2, kRate, kBias);
  add_noise(samples, {.gyro = 5e-4, .accel = 5e-3}, kRate, random);
  fault(samples);

  InertialTracker tracker(imu, 0.0, velocity_config());
  int measured = 0;
  MotionModel steady;
  Outcome outcome;
  size_t fed = 0;
  std::optional<StampedPose> last;  // the truth at the last sweep
  for (int i = 0; i * kSweep < duration; ++i) {
    const double time = kSweep * i + (sweeps.delay ? sweeps.delay(i) : 0.0);
    for (; fed < samples.size() && samples[fed].stamp <= at_seconds(time + kSweep); ++fed) {
      tracker.add(samples[fed]);
    }
    for (; velocity && measured / kVelocityRate <= time + kSweep; ++measured) {
      const double when = measured / kVelocityRate;
      const NavState then = motion.state(when);
      tracker.add(
          {.stamp = at_seconds(when),
           .linear = velocity(when, then.T_map_body.linear().transpose() * then.v_map_body)},
          VelocitySource::sensor);
    }
    const Nanoseconds stamp = at_seconds(time);
    const Eigen::Isometry3d truth = motion.state(time).T_map_body * T_body_lidar();
    const Eigen::Isometry3d guess = steady.predict(stamp).T_map_lidar;
    outcome.measured.push_back(last ? tracker.measured_motion(last->stamp, stamp) : std::nullopt);
    outcome.measured_errors.push_back(outcome.measured.back()
                                          ? (outcome.measured.back()->T_begin_end.translation() -
                                             (last->pose.inverse() * truth).translation())
                                                .norm()
                                          : 0.0);
    last = StampedPose{stamp, truth};
    tracker.predict(stamp, kSweep);
    Vector6d error = Vector6d::NullaryExpr([&] { return normal(random); });
    error.head<3>() *= 0.002;
    error.tail<3>() *= 0.0003;
    RegistrationResult alignment;
    alignment.status = RegistrationStatus::converged;
    alignment.T_target_source = retract(truth, error);
    alignment.information = 1e6 * Matrix6d::Identity();
    alignment.overlap = 1.0;
    alignment.inliers = alignment.matches = alignment.source_points = 1000;
    if (sweeps.alignment) {
      sweeps.alignment(i, alignment);
    }
    const bool aligned = i > 0 && !(sweeps.unaligned && sweeps.unaligned(i));
    const StampedPose pose{stamp, aligned || i == 0 ? alignment.T_target_source : guess};
    outcome.reports.push_back(tracker.update(pose, aligned ? &alignment : nullptr, guess));
    const InertialReport& report = outcome.reports.back();
    const Eigen::Isometry3d result = report.nav ? tracker.T_map_lidar(*report.nav) : pose.pose;
    EXPECT_TRUE(result.matrix().allFinite());
    outcome.errors.push_back((result.translation() - truth.translation()).norm());
    steady.update({stamp, result}, aligned || i == 0);
  }
  return outcome;
}

/// Removes the readings of a time (s).
inline Fault without(double begin, double end) {
  return [=](std::vector<ImuSample>& samples) {
    std::erase_if(samples, [&](const ImuSample& sample) {
      return sample.stamp > at_seconds(begin) && sample.stamp < at_seconds(end);
    });
  };
}

inline Fault each(const std::function<void(ImuSample&)>& change) {
  return [=](std::vector<ImuSample>& samples) { std::ranges::for_each(samples, change); };
}

}  // namespace adit::test
