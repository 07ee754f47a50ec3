// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The tracker with alignments that are made up from the truth.
#include "adit/slam/fusion/inertial_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "adit/tests/slam/tracker_runs.hpp"

namespace adit {
namespace {

using test::each;
using test::kBias;
using test::kRate;
using test::Outcome;
using test::T_body_lidar;
using test::tracker_config;
using test::without;

Outcome run(const test::Fault& fault, double duration = 10.0,
            const ImuConfig& imu = tracker_config()) {
  return test::run_tracker(fault, duration, imu);
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
  InertialTracker tracker(tracker_config());
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
  const auto gaps = outcome.all<GapTooLong>();
  ASSERT_EQ(gaps.size(), 1U) << outcome.events();
  EXPECT_NEAR(gaps[0].gap, test::kSweep, 0.006) << "by the next sweep";
  EXPECT_LT(gaps[0].limit, gaps[0].gap);
  EXPECT_EQ(outcome.starts<StartedAfterGap>().size(), 1U) << outcome.events();
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

TEST(InertialTracker, SweepsThatAreMissingHereAndThereDoNotKeepItFromStarting) {
  for (const int every : {10, 5, 2}) {
    const Outcome outcome = test::run_tracker(
        [](std::vector<ImuSample>&) {}, 10.0, test::tracker_config(), test::hand_held_motion(),
        {.unaligned = [=](int i) { return i % every == every - 1; }});
    EXPECT_EQ(outcome.state_at(4.0), InertialState::fused) << every << "\n" << outcome.events();
    EXPECT_FALSE(outcome.reports.back().hindrance);
    EXPECT_LE(outcome.error_after(4.0), 0.05) << every;
  }
}

TEST(InertialTracker, SaysHowManySweepsAStartStillNeeds) {
  // One in fifteen is aligned, which is one in 1.5 s.
  const Outcome outcome =
      test::run_tracker([](std::vector<ImuSample>&) {}, 6.0, test::tracker_config(),
                        test::hand_held_motion(), {.unaligned = [](int i) { return i % 15 != 1; }});
  EXPECT_EQ(outcome.state_at(5.9), InertialState::starting) << outcome.events();
  ASSERT_TRUE(outcome.reports.back().hindrance);
  const auto* few = std::get_if<FewAligned>(&*outcome.reports.back().hindrance);
  ASSERT_NE(few, nullptr);
  EXPECT_LE(few->sweeps, 1U);
  EXPECT_EQ(few->needed, 8U);
}

TEST(InertialTracker, AnAccelerometerInGOrOfTheOtherSignIsUnderstood) {
  for (const double scale : {1.0 / kStandardGravity, -1.0, -1.0 / kStandardGravity}) {
    const Outcome outcome =
        run(each([=](ImuSample& sample) { sample.linear_acceleration *= scale; }));
    EXPECT_EQ(outcome.state_at(9.9), InertialState::fused) << outcome.events();
    const auto starts = outcome.starts<StartedInMotion>();
    ASSERT_FALSE(starts.empty()) << outcome.events();
    EXPECT_EQ(starts[0].negative, scale < 0.0);
    EXPECT_EQ(starts[0].in_g, std::abs(scale) < 1.0);
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

/// Each state that is handed out has a covariance that is one.
void expect_covariances(const Outcome& outcome) {
  for (const InertialReport& report : outcome.reports) {
    if (report.nav) {
      ASSERT_TRUE(report.nav_covariance.allFinite()) << outcome.events();
      ASSERT_GT(report.nav_covariance.diagonal().minCoeff(), 0.0) << outcome.events();
    }
  }
}

TEST(InertialTracker, AnAlignmentWhoseInformationIsNotFiniteLosesItForAWhile) {
  for (const double information : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    const Outcome outcome =
        test::run_tracker([](auto&) {}, 10.0, tracker_config(), test::hand_held_motion(),
                          {.alignment = [=](int i, RegistrationResult& alignment) {
                            alignment.information(2, 2) = i == 40 ? information : 1e6;
                          }});
    EXPECT_EQ(outcome.state_at(3.9), InertialState::fused) << outcome.events();
    EXPECT_EQ(outcome.state_at(4.0), InertialState::lost) << outcome.events();
    const auto failed = outcome.all<CheckFailed>();
    ASSERT_EQ(failed.size(), 1U) << outcome.events();
    const auto* state = std::get_if<ImpossibleState>(&failed[0].check);
    ASSERT_NE(state, nullptr);
    EXPECT_EQ(state->quantity, StateQuantity::state);
    EXPECT_EQ(outcome.state_at(9.9), InertialState::fused) << outcome.events();
    expect_covariances(outcome);
  }
}

// Sweeps that hardly follow one another tie the biases of their states so firmly that rounding
// hides all else: the worst that valid settings and rising stamps can do.
TEST(InertialTracker, AGraphThatDeterminesNothingLosesTheSensorAndNotTheRun) {
  ImuConfig firm = tracker_config();
  firm.sensor = "custom";
  firm.gyro_walk = firm.accel_walk = firm.gravity_walk = 1e-9;
  int undetermined = 0;
  for (const double apart : {1e-9, 1e-8, 1e-7}) {
    const Outcome outcome = test::run_tracker(
        [](auto&) {}, 10.0, firm, test::hand_held_motion(),
        {.delay = [=](int i) { return i >= 30 && i % 2 == 1 ? apart - test::kSweep : 0.0; }});
    expect_covariances(outcome);
    for (const CheckFailed& failed : outcome.all<CheckFailed>()) {
      undetermined += std::holds_alternative<StateUndetermined>(failed.check) ? 1 : 0;
    }
    EXPECT_TRUE(std::isfinite(outcome.error_after(0.0))) << outcome.events();
    EXPECT_LE(outcome.error_after(0.0), 0.1) << outcome.events();
  }
  EXPECT_GE(undetermined, 1);
}

TEST(InertialTracker, NotToBeUsedItStaysOut) {
  ImuConfig off = tracker_config();
  off.use = false;
  const Outcome outcome = run([](auto&) {}, 3.0, off);
  EXPECT_EQ(outcome.reports.back().state, InertialState::absent);
}

}  // namespace
}  // namespace adit
