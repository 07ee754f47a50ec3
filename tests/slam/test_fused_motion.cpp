// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is believed of alignments beside the prediction, and how large errors are said to be.
#include "adit/slam/fusion/fused_motion.hpp"

#include <gtest/gtest.h>

#include "adit/tests/slam/tracker_runs.hpp"

namespace adit {
namespace {

using test::Outcome;
using test::run_tracker;

const auto untouched = [](std::vector<ImuSample>& /*samples*/) {};

/// Alignments of a stretch (s) that are off to the side (m), in a direction that is held weakly or
/// not.
test::SweepFault off_for_a_while(double begin, double end, double by, Localizability held) {
  return {.alignment = [=](int i, RegistrationResult& alignment) {
    const double time = test::kSweep * i;
    alignment.translation[0].axis = Eigen::Vector3d::UnitY();
    alignment.translation[0].localizability = held;
    if (time > begin && time < end) {
      alignment.T_target_source = alignment.T_target_source * Eigen::Translation3d(0.0, by, 0.0);
    }
  }};
}

Outcome run(const test::SweepFault& fault) {
  return run_tracker(untouched, 10.0, test::tracker_config(), test::hand_held_motion(), fault);
}

// Rings of the ground lock on rings of the ground for some sweeps: no reason to leave the sensor
// that tells.
TEST(FusedMotion, WeakAlignmentsThatAreOffForAWhileDoNotCostTheSensor) {
  const Outcome weak = run(off_for_a_while(5.05, 5.35, 0.1, Localizability::partial));
  EXPECT_TRUE(weak.all<CheckFailed>().empty()) << weak.events();
  EXPECT_EQ(weak.state_at(9.9), InertialState::fused);
  EXPECT_LE(weak.error_after(5.0), 0.04) << "they are hardly followed";
  // Where all directions are held, the sensor is what is wrong.
  const Outcome held = run(off_for_a_while(5.05, 5.35, 0.1, Localizability::full));
  EXPECT_FALSE(held.all<CheckFailed>().empty());
  // And where sweep after sweep contradicts it.
  const Outcome lasting = run({.alignment = [](int i, RegistrationResult& alignment) {
    alignment.translation[0].axis = Eigen::Vector3d::UnitY();
    alignment.translation[0].localizability = Localizability::partial;
    if (i > 50) {
      const double by = i % 2 == 0 ? 0.3 : -0.3;
      alignment.T_target_source = alignment.T_target_source * Eigen::Translation3d(0.0, by, 0.0);
    }
  }});
  EXPECT_FALSE(lasting.all<CheckFailed>().empty()) << lasting.events();
}

TEST(FusedMotion, OneAlignmentThatIsFarOffIsHardlyFollowed) {
  const Outcome one = run(off_for_a_while(5.95, 6.05, 0.1, Localizability::full));
  EXPECT_TRUE(one.all<CheckFailed>().empty()) << one.events();
  EXPECT_LE(one.error_after(5.0), 0.01);
}

// The pose's covariance follows what innovations tell of the alignments' errors.
TEST(FusedMotion, CovariancesGrowWithInnovations) {
  const auto sigma_of = [](double noise) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal(0.0, noise);
    const Outcome outcome = run({.alignment = [&](int /*i*/, RegistrationResult& alignment) {
      alignment.T_target_source =
          alignment.T_target_source *
          Eigen::Translation3d(normal(random), normal(random), normal(random));
    }});
    EXPECT_EQ(outcome.state_at(9.9), InertialState::fused) << outcome.events();
    return std::sqrt(outcome.reports.back().lidar_covariance(0, 0));
  };
  const double quiet = sigma_of(0.0);
  const double noisy = sigma_of(0.006);
  EXPECT_GE(noisy, 1.7 * quiet);
  EXPECT_LE(noisy, 6.0 * quiet);
}

}  // namespace
}  // namespace adit
