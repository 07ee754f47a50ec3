// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A sensor of velocities where sweeps hold one direction less, right and wrong in the usual ways.
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "adit/tests/slam/tracker_runs.hpp"

namespace adit {
namespace {

using test::Outcome;

constexpr double kLasts = 30.0;  // s
constexpr double kOpens = 10.0;  // s: from then on no match holds the position along x
const auto untouched = [](std::vector<ImuSample>& /*samples*/) {};

/// A walk with turns of the head, slower and faster.
test::WavyMotion walk() {
  test::WavyMotion motion = test::hand_held_motion();
  motion.position[0] = {.amplitude = 0.3, .frequency = 0.15, .phase = 0.0, .speed = 1.0};
  return motion;
}

Outcome run(const test::VelocityReading& velocity) {
  const test::SweepFault open = {.alignment = [](int i, RegistrationResult& alignment) {
    if (test::kSweep * i < kOpens) {
      return;
    }
    const Eigen::Vector3d along =
        alignment.T_target_source.linear().transpose() * Eigen::Vector3d::UnitX();
    Matrix6d keep = Matrix6d::Identity();
    keep.topLeftCorner<3, 3>() -= along * along.transpose();
    alignment.information = keep * alignment.information * keep;
    alignment.translation[0].axis = along;
    alignment.translation[0].localizability = Localizability::none;
  }};
  return test::run_tracker(untouched, kLasts, test::tracker_config(), walk(), open, velocity);
}

/// The last sweep's report of the sensor.
VelocityReport last_report(const Outcome& outcome) {
  const auto& last = outcome.reports.back().velocities;
  EXPECT_EQ(last.size(), 1U);
  return last.empty() ? VelocityReport{} : last.front();
}

std::size_t refused(const Outcome& outcome) {
  return static_cast<std::size_t>(std::ranges::count_if(outcome.reports, [](const auto& report) {
    return !report.velocities.empty() && report.velocities.front().refused;
  }));
}

test::VelocityReading noisy(const test::VelocityReading& reading) {
  return [reading, random = std::make_shared<std::mt19937_64>(5)](double time,
                                                                  const Eigen::Vector3d& truth) {
    std::normal_distribution<double> normal(0.0, 0.03);
    return Eigen::Vector3d(reading(time, truth) +
                           Eigen::Vector3d::NullaryExpr([&] { return normal(*random); }));
  };
}

const test::VelocityReading right = noisy([](double, const Eigen::Vector3d& v) { return v; });

TEST(VelocityFusion, BeforeTheStartTheWayLeadsToTheNextSweep) {
  const Outcome outcome = run(right);
  std::size_t before = 0;
  for (std::size_t i = 1; i < outcome.reports.size(); ++i) {
    const bool fused = outcome.reports[i - 1].state == InertialState::fused;
    ASSERT_EQ(outcome.measured[i].has_value(), !fused) << i;
    if (fused) {
      continue;
    }
    ++before;
    EXPECT_LT(outcome.measured_errors[i], 0.015) << i;
    const Matrix6d& covariance = outcome.measured[i]->covariance;
    EXPECT_LT(std::sqrt(covariance.diagonal().head<3>().maxCoeff()), 0.03);
    EXPECT_LT(outcome.measured_errors[i], 4.0 * std::sqrt(covariance.diagonal().head<3>().sum()));
  }
  EXPECT_GE(before, 5U);
}

TEST(VelocityFusion, BeforeTheStartWhatAlignmentsContradictLeadsNowhere) {
  const auto stuck = [](double, const Eigen::Vector3d& /*v*/) {
    return Eigen::Vector3d(Eigen::Vector3d::Zero());
  };
  const auto in_kilometres_an_hour = [](double, const Eigen::Vector3d& v) {
    return Eigen::Vector3d(3.6 * v);
  };
  const auto reversed = [](double, const Eigen::Vector3d& v) { return Eigen::Vector3d(-v); };
  for (const test::VelocityReading& wrong :
       {test::VelocityReading(stuck), test::VelocityReading(in_kilometres_an_hour),
        test::VelocityReading(reversed)}) {
    const Outcome outcome = run(wrong);
    EXPECT_TRUE(outcome.measured[1].has_value());
    for (std::size_t i = 3; i < outcome.measured.size(); ++i) {
      EXPECT_FALSE(outcome.measured[i].has_value()) << i;
    }
  }
}

TEST(VelocityFusion, HoldsTheDirectionThatNoMatchHolds) {
  const double without = run({}).error_after(0.0);
  const Outcome with = run(right);
  EXPECT_GE(without, 0.3) << "inertia alone drifts, or the test shows nothing";
  EXPECT_LE(with.error_after(0.0), 0.12);
  EXPECT_EQ(refused(with), 0U);
  EXPECT_LE(last_report(with).innovation.error.norm(), 0.2);
}

TEST(VelocityFusion, EstimatesScaleAndMounting) {
  const Outcome outcome = run(noisy([](double, const Eigen::Vector3d& v) {
    return Eigen::Vector3d((v - Eigen::Vector3d(0.0, 0.02, -0.04).cross(v)) / 1.05);
  }));
  ASSERT_TRUE(outcome.reports.back().nav);
  const VelocityCalibration& found = outcome.reports.back().nav->velocity;
  EXPECT_NEAR(found.scale, 0.05, 0.01);
  EXPECT_NEAR(found.turn[0], 0.02, 0.01);
  EXPECT_NEAR(found.turn[1], -0.04, 0.01);
  EXPECT_LE(outcome.error_after(0.0), 0.3);
  EXPECT_EQ(refused(outcome), 0U);
}

TEST(VelocityFusion, BurstsOfSlipAreOutliers) {
  const Outcome outcome = run(noisy([](double time, const Eigen::Vector3d& v) {
    const bool slips = std::fmod(time, 6.0) > 5.0;
    return Eigen::Vector3d(slips ? 1.5 * v : v);
  }));
  EXPECT_LE(outcome.error_after(0.0), 0.3);
  EXPECT_EQ(refused(outcome), 0U);
}

// None makes it worse than without, and each says what it is.
TEST(VelocityFusion, ASourceThatIsNotThisBodysVelocityIsRefused) {
  const double without = run({}).error_after(0.0);
  const auto expect_refused = [&](const char* what, const test::VelocityReading& reading) {
    const Outcome outcome = run(noisy(reading));
    EXPECT_LE(outcome.error_after(0.0), 1.1 * without) << what;
    EXPECT_GE(refused(outcome), outcome.reports.size() / 2) << what;
    const auto comparison = last_report(outcome).comparison;
    EXPECT_TRUE(comparison) << what;
    return comparison.value_or(VelocityComparison{});
  };
  const auto stuck = expect_refused(
      "stuck", [](double, const Eigen::Vector3d& v) { return Eigen::Vector3d(0.0 * v); });
  EXPECT_LE(stuck.measured_speed, 0.1 * stuck.speed);
  const auto fast = expect_refused(
      "km/h", [](double, const Eigen::Vector3d& v) { return Eigen::Vector3d(3.6 * v); });
  EXPECT_NEAR(fast.scale, 1.0 / 3.6, 0.1 / 3.6) << "what inertia alone predicts is not exact";
  EXPECT_LE(fast.turn, 0.1);
  const auto reversed = expect_refused(
      "reversed", [](double, const Eigen::Vector3d& v) { return Eigen::Vector3d(-v); });
  EXPECT_GE(reversed.turn, 3.0);
  const auto swapped = expect_refused("axes", [](double, const Eigen::Vector3d& v) {
    return Eigen::Vector3d(v.y(), v.x(), v.z());
  });
  EXPECT_GE(std::max(swapped.turn, swapped.left / swapped.speed), 0.25);
}

}  // namespace
}  // namespace adit
