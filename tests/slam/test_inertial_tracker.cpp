// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The tracker with alignments that are made up from the truth, and everything that can be wrong
// with an inertial sensor.
#include "slam/inertial_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "tests/support/simulated_imu.hpp"

namespace adit {
namespace {

constexpr double kRate = 200.0;
constexpr double kSweep = 0.1;  // s
const ImuBias kBias{{0.02, -0.01, 0.015}, {0.05, -0.03, 0.04}};

/// The lidar is not where the IMU is, and looks elsewhere.
ImuConfig config() {
  ImuConfig config;
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()));
  config.T_imu_lidar = {0.1, -0.05, 0.2, q.x(), q.y(), q.z(), q.w()};
  return config;
}

Eigen::Isometry3d T_body_lidar() {
  const auto v = config().T_imu_lidar;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(v[6], v[3], v[4], v[5]).toRotationMatrix();
  pose.translation() << v[0], v[1], v[2];
  return pose;
}

struct Outcome {
  std::vector<InertialReport> reports;
  std::vector<double> errors;  ///< m, of the lidar's position after each sweep
  double error_after(double time) const {
    const auto from = static_cast<std::ptrdiff_t>(time / kSweep);
    return *std::max_element(errors.begin() + from, errors.end());
  }
  InertialState state_at(double time) const {
    return reports[static_cast<size_t>(time / kSweep)].state;
  }
  std::string events() const {
    std::string text;
    for (size_t i = 0; i < reports.size(); ++i) {
      text += reports[i].event.empty() ? "" : std::to_string(i) + ": " + reports[i].event + "\n";
    }
    return text;
  }
};

/// Changes the readings before they are handed on.
using Fault = std::function<void(std::vector<ImuSample>&)>;

/// Ten seconds by hand, alignments good to 2 mm and 0.3 mrad.
Outcome run(const Fault& fault, double duration = 10.0, const ImuConfig& imu = config()) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const test::WavyMotion motion = test::hand_held_motion();
  std::vector<ImuSample> samples = test::readings(motion, -0.1, duration + 0.2, kRate, kBias);
  test::add_noise(samples, {.gyro = 5e-4, .accel = 5e-3}, kRate, random);
  fault(samples);

  InertialTracker tracker(imu);
  MotionModel steady;
  Outcome outcome;
  size_t fed = 0;
  for (int i = 0; i * kSweep < duration; ++i) {
    const double time = kSweep * i;
    for (; fed < samples.size() && samples[fed].stamp <= test::at_seconds(time + kSweep); ++fed) {
      tracker.add(samples[fed]);
    }
    const Nanoseconds stamp = test::at_seconds(time);
    const Eigen::Isometry3d truth = motion.state(time).T_map_body * T_body_lidar();
    const Eigen::Isometry3d guess = steady.predict(stamp).T_map_lidar;
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
    const StampedPose pose{stamp, alignment.T_target_source};
    outcome.reports.push_back(tracker.update(pose, i == 0 ? nullptr : &alignment, guess));
    const InertialReport& report = outcome.reports.back();
    const Eigen::Isometry3d result = report.nav ? tracker.T_map_lidar(*report.nav) : pose.pose;
    EXPECT_TRUE(result.matrix().allFinite());
    outcome.errors.push_back((result.translation() - truth.translation()).norm());
    steady.update({stamp, result}, true);
  }
  return outcome;
}

/// Removes the readings of a time (s).
Fault without(double begin, double end) {
  return [=](std::vector<ImuSample>& samples) {
    std::erase_if(samples, [&](const ImuSample& sample) {
      return sample.stamp > test::at_seconds(begin) && sample.stamp < test::at_seconds(end);
    });
  };
}

Fault each(const std::function<void(ImuSample&)>& change) {
  return [=](std::vector<ImuSample>& samples) { std::ranges::for_each(samples, change); };
}

TEST(InertialTracker, StartsInMotionAndFuses) {
  const Outcome good = run([](auto&) {});
  EXPECT_EQ(good.state_at(0.5), InertialState::starting);
  EXPECT_EQ(good.state_at(2.0), InertialState::fused) << good.events();
  EXPECT_EQ(good.state_at(9.9), InertialState::fused) << good.events();
  EXPECT_LE(good.error_after(2.0), 0.05);
  const NavState& nav = *good.reports.back().nav;
  EXPECT_LE((nav.bias.gyro - kBias.gyro).norm(), 5e-3);
  const StateMatrix& covariance = good.reports.back().nav_covariance;
  EXPECT_EQ(Eigen::LLT<StateMatrix>(covariance).info(), Eigen::Success);
  EXPECT_LT((nav.bias.gyro - kBias.gyro).norm(), 5.0 * std::sqrt(covariance(9, 9)));
  EXPECT_TRUE(good.reports.front().nav_covariance.isZero());
  int turns = 0;
  int travels = 0;
  for (size_t i = 30; i < 100; ++i) {
    turns += good.reports[i].better_turn ? 1 : 0;
    travels += good.reports[i].better_travel ? 1 : 0;
  }
  EXPECT_GE(turns, 60);
  EXPECT_GE(travels, 50);
}

TEST(InertialTracker, LevelsTheFirstSweep) {
  InertialTracker tracker(config());
  EXPECT_FALSE(tracker.level_lidar(Nanoseconds(0), test::at_seconds(0.1)));
  const test::WavyMotion still{.position = {},
                               .angles = {{{0.2, 0.0, std::numbers::pi / 2, 0.0}, {}, {}}}};
  for (const ImuSample& sample : test::readings(still, 0.0, 0.1, kRate)) {
    tracker.add(sample);
  }
  const auto R_map_lidar = tracker.level_lidar(Nanoseconds(0), test::at_seconds(0.1));
  ASSERT_TRUE(R_map_lidar);
  const Eigen::Vector3d up_body =
      Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d up_lidar = T_body_lidar().linear().transpose() * up_body;
  EXPECT_LE((*R_map_lidar * up_lidar - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(InertialTracker, AGapOfTenMillisecondsIsBridged) {
  const Outcome outcome = run(without(5.0, 5.011));
  EXPECT_EQ(outcome.state_at(5.5), InertialState::fused) << outcome.events();
  EXPECT_LE(outcome.error_after(2.0), 0.05);
}

TEST(InertialTracker, AGapOfASecondIsReportedAndRecoveredFrom) {
  const Outcome outcome = run(without(5.0, 6.0));
  EXPECT_EQ(outcome.state_at(5.5), InertialState::lost) << outcome.events();
  EXPECT_NE(outcome.events().find("no IMU readings for"), std::string::npos) << outcome.events();
  EXPECT_EQ(outcome.state_at(6.5), InertialState::fused) << outcome.events();
  EXPECT_LE(outcome.error_after(2.0), 0.05);
}

TEST(InertialTracker, DuplicatesAndReversedStampsChangeNothing) {
  const Outcome clean = run([](auto&) {});
  const Outcome outcome = run([](std::vector<ImuSample>& samples) {
    for (size_t i = 10; i + 1 < samples.size(); i += 10) {
      std::swap(samples[i], samples[i + 1]);
    }
    for (size_t i = 5; i < samples.size(); i += 50) {
      samples.insert(samples.begin() + static_cast<std::ptrdiff_t>(i), samples[i]);
    }
  });
  EXPECT_EQ(outcome.state_at(9.9), InertialState::fused) << outcome.events();
  EXPECT_NEAR(outcome.error_after(2.0), clean.error_after(2.0), 0.01);
}

TEST(InertialTracker, ReadingsThatAreNoNumbersAreLeftOut) {
  const Outcome outcome = run([](std::vector<ImuSample>& samples) {
    for (size_t i = 3; i < samples.size(); i += 7) {
      samples[i].angular_velocity.x() = std::numeric_limits<double>::quiet_NaN();
    }
  });
  EXPECT_EQ(outcome.state_at(9.9), InertialState::fused) << outcome.events();
  EXPECT_LE(outcome.error_after(2.0), 0.05);
}

TEST(InertialTracker, AnAccelerometerInGOrOfTheOtherSignIsUnderstood) {
  for (const double scale : {1.0 / kStandardGravity, -1.0, -1.0 / kStandardGravity}) {
    const Outcome outcome =
        run(each([=](ImuSample& sample) { sample.linear_acceleration *= scale; }));
    EXPECT_EQ(outcome.state_at(9.9), InertialState::fused) << outcome.events();
    EXPECT_NE(outcome.events().find(scale < 0.0 ? "opposite sign" : "in g"), std::string::npos)
        << outcome.events();
    EXPECT_LE(outcome.error_after(3.0), 0.05) << scale;
  }
}

TEST(InertialTracker, AnImuThatStartsLateOrEndsEarlyIsUsedWhileItIsThere) {
  const Outcome outcome = run([](std::vector<ImuSample>& samples) {
    without(-1.0, 3.0)(samples);
    without(8.0, 100.0)(samples);
  });
  EXPECT_EQ(outcome.state_at(2.0), InertialState::absent) << outcome.events();
  EXPECT_EQ(outcome.state_at(6.0), InertialState::fused) << outcome.events();
  EXPECT_EQ(outcome.state_at(9.0), InertialState::lost) << outcome.events();
  EXPECT_LE(outcome.error_after(0.0), 0.06);
}

/// What must hold where the sensor cannot be right: never fused for long, or at least no harm, and
/// a reason with what to look at.
void expect_noticed(const Outcome& outcome, const char* what) {
  EXPECT_NE(outcome.reports.back().state, InertialState::absent) << what;
  EXPECT_LE(outcome.error_after(0.0), 0.15) << what << "\n" << outcome.events();
  const bool refused = std::ranges::any_of(outcome.reports, [](const InertialReport& report) {
    return report.state == InertialState::lost || report.state == InertialState::refused;
  });
  const bool never = std::ranges::none_of(outcome.reports, [](const InertialReport& report) {
    return report.state == InertialState::fused;
  });
  int compared = 0;
  int better = 0;
  for (const InertialReport& report : outcome.reports) {
    compared += report.compared ? 1 : 0;
    better += report.better_turn ? 1 : 0;
  }
  EXPECT_TRUE(refused || never || 2 * better < compared) << what << "\n" << outcome.events();
}

TEST(InertialTracker, AConstantImuIsNoticedAndDoesNoHarm) {
  expect_noticed(run(each([](ImuSample& sample) {
                   sample.angular_velocity << 0.0, 0.0, 0.0;
                   sample.linear_acceleration << 0.0, 0.0, kStandardGravity;
                 })),
                 "constant");
}

TEST(InertialTracker, AGyroscopeInDegreesIsNoticedAndDoesNoHarm) {
  expect_noticed(
      run(each([](ImuSample& sample) { sample.angular_velocity *= 180.0 / std::numbers::pi; })),
      "degrees");
}

TEST(InertialTracker, AClockThatIsATenthOfASecondOffIsNoticedAndDoesNoHarm) {
  expect_noticed(run(each([](ImuSample& sample) { sample.stamp += test::at_seconds(0.1); })),
                 "late");
  expect_noticed(run(each([](ImuSample& sample) { sample.stamp -= test::at_seconds(0.1); })),
                 "early");
}

TEST(InertialTracker, AWrongMountingIsNoticedAndDoesNoHarm) {
  ImuConfig wrong = config();
  wrong.T_imu_lidar = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};
  expect_noticed(run([](auto&) {}, 10.0, wrong), "mounting");
}

TEST(InertialTracker, SaturationForASecondIsRecoveredFrom) {
  const Outcome outcome = run(each([](ImuSample& sample) {
    if (sample.stamp > test::at_seconds(5.0) && sample.stamp < test::at_seconds(6.0)) {
      sample.angular_velocity = sample.angular_velocity.cwiseMax(-0.5).cwiseMin(0.5);
      sample.linear_acceleration = sample.linear_acceleration.cwiseMax(-8.0).cwiseMin(8.0);
    }
  }));
  EXPECT_LE(outcome.error_after(0.0), 0.15) << outcome.events();
  EXPECT_EQ(outcome.state_at(9.9), InertialState::fused) << outcome.events();
  EXPECT_LE(outcome.error_after(9.0), 0.06) << outcome.events();
}

TEST(InertialTracker, NotToBeUsedItStaysOut) {
  ImuConfig off = config();
  off.use = 0;
  const Outcome outcome = run([](auto&) {}, 3.0, off);
  EXPECT_EQ(outcome.reports.back().state, InertialState::absent);
}

}  // namespace
}  // namespace adit
