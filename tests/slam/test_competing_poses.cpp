// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Places that repeat have more than one pose that fits.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/registration/competing_poses.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using test::World;

constexpr double kPillarPeriod = 1.5;  // m

World corridor(bool pillars) {
  World world{.blocks = {{{-200, -3.5, 0}, {200, -2.5, 4}},
                         {{-200, 2.5, 0}, {200, 3.5, 4}},
                         {{-200, -3.5, 4}, {200, 3.5, 5}}},
              .poles = {}};
  for (int i = -60; pillars && i < 60; ++i) {
    for (const double y : {-2.5, 2.2}) {
      world.blocks.push_back({{kPillarPeriod * i, y, 0}, {kPillarPeriod * i + 0.4, y + 0.3, 4}});
    }
  }
  return world;
}

World small_room() {
  return {.blocks = {{{-7, -5, 0}, {-6, 5, 3}},
                     {{6, -5, 0}, {7, 5, 3}},
                     {{-6, -5, 0}, {6, -4, 3}},
                     {{-6, 4, 0}, {6, 5, 3}},
                     {{-4, -2, 0}, {-3, -1, 1}},
                     {{1, 1.5, 0}, {2.5, 2.5, 2}}},
          .poles = {}};
}

class CompetingPosesTest : public test::DeviceTest {
 protected:
  struct Outcome {
    RegistrationResult result;
    std::optional<CompetingPose> competing;
  };
  static Outcome run(const World& world) {
    test::Lidar lidar{.beams = 64, .columns = 700, .lowest = -0.5, .highest = 0.5};
    lidar.range_noise = 0.02;
    PreprocessConfig config;
    config.r_input = 0.1;
    config.beam_spacing = lidar.beam_spacing();
    config.surface_size = 0.625;
    AlignmentClouds maker(context(), config);
    const auto cloud = [&](double x, int stamp) {
      StampedPose pose{.stamp = Nanoseconds(stamp)};
      pose.pose.translation() << x, 0.1, 1.4;
      return maker.make_cloud(test::scan(world, pose, lidar, 5).points);
    };
    const SurfaceCloud target_cloud = cloud(0.2, 1);
    const SurfaceCloud source = cloud(0.4, 2);
    const AlignmentTarget target =
        maker.make_target(target_cloud, RegistrationMethod::vgicp, std::vector{0.5});
    AlignmentSettings settings;
    settings.max_iterations = 50;
    settings.d_max = 0.75;
    BatchAligner aligner(context(), settings);
    const AlignmentPair pair{.source = &source, .target = &target};
    const std::vector<AlignmentPair> pairs = {pair};
    const std::vector<RegistrationResult> results = aligner.align(pairs);
    return {results.front(), find_competing_poses(aligner, pairs, results).front()};
  }
};

TEST_F(CompetingPosesTest, ARoomHasOnePose) {
  const Outcome found = run(small_room());
  ASSERT_EQ(found.result.status, RegistrationStatus::converged);
  EXPECT_FALSE(found.competing.has_value()) << "at " << found.competing->apart << " m";
}

TEST_F(CompetingPosesTest, PillarsThatRepeatHaveOneAPeriodAway) {
  const Outcome found = run(corridor(true));
  ASSERT_TRUE(is_usable(found.result.status)) << to_string(found.result.status);
  EXPECT_NEAR(found.result.T_target_source.translation().x(), 0.2, 0.03);
  ASSERT_TRUE(found.competing.has_value());
  EXPECT_NEAR(std::abs(found.competing->apart), kPillarPeriod, 0.05);
}

TEST_F(CompetingPosesTest, ASmoothCorridorHasThemAnywhere) {
  const Outcome found = run(corridor(false));
  ASSERT_EQ(found.result.status, RegistrationStatus::degenerate);
  EXPECT_TRUE(found.competing.has_value());
}

TEST_F(CompetingPosesTest, NeedsAResultAPair) {
  BatchAligner aligner(context(), {});
  const std::vector<AlignmentPair> pairs(1);
  EXPECT_THROW(find_competing_poses(aligner, pairs, {}), std::logic_error);
  EXPECT_TRUE(find_competing_poses(aligner, {}, {}).empty());
}

}  // namespace
}  // namespace adit
