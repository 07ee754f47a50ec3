// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/motion.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/crossings.hpp"
#include "adit/tools/simulator/ray_scene.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

SplineTrajectory random_spline() {
  const CounterRandom random(4, RandomStream::scene);
  std::vector<Eigen::Isometry3d> poses;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (uint64_t i = 0; i < 12; ++i) {
    pose.linear() = pose.linear() * so3_exp(0.6 * random.gaussian_vector(2 * i));
    pose.translation() += random.gaussian_vector(2 * i + 1);
    poses.push_back(pose);
  }
  return {0.5, poses};
}

TEST(SplineTrajectory, DerivativesAreThoseOfItsPoses) {
  const SplineTrajectory spline = random_spline();
  ASSERT_DOUBLE_EQ(spline.duration(), 4.5);
  constexpr double h = 1e-4;
  for (double time = 0.1; time < 4.4; time += 0.037) {
    const MotionState state = spline.at(time);
    const MotionState before = spline.at(time - h);
    const MotionState after = spline.at(time + h);
    const Vector3d velocity =
        (after.T_world_body.translation() - before.T_world_body.translation()) / (2 * h);
    const Vector3d acceleration = (after.velocity - before.velocity) / (2 * h);
    const Vector3d turn =
        so3_log(before.T_world_body.linear().transpose() * after.T_world_body.linear()) / (2 * h);
    EXPECT_LT((state.velocity - velocity).norm(), 2e-6) << time;
    EXPECT_LT((state.angular_velocity - turn).norm(), 2e-5) << time;
    // The third derivative jumps at the knots.
    const bool near_knot = std::abs(time / 0.5 - std::round(time / 0.5)) < 3e-4;
    EXPECT_LT((state.acceleration - acceleration).norm(), near_knot ? 0.1 : 1e-6) << time;
    EXPECT_LT((spline.pose(time).matrix() - state.T_world_body.matrix()).norm(), 1e-14);
  }
}

TEST(SplineTrajectory, AccelerationAndTurningAreContinuousAtTheKnots) {
  const SplineTrajectory spline = random_spline();
  for (int knot = 1; knot < 9; ++knot) {
    const MotionState before = spline.at(0.5 * knot - 1e-9);
    const MotionState after = spline.at(0.5 * knot + 1e-9);
    EXPECT_LT((before.acceleration - after.acceleration).norm(), 1e-6);
    EXPECT_LT((before.angular_velocity - after.angular_velocity).norm(), 1e-6);
  }
}

TEST(SplineTrajectory, WithoutAPartOfItTheRestIsAsItWas) {
  const SplineTrajectory whole = random_spline();
  const SplineTrajectory cut = whole.cut_out(1.2, 2.0);
  EXPECT_DOUBLE_EQ(cut.duration(), whole.duration() - 2.0);
  for (const double time : {0.0, 0.7, 1.199}) {
    EXPECT_EQ(cut.pose(time).matrix(), whole.pose(time).matrix());
  }
  for (const double time : {1.2, 1.9, 2.4}) {
    EXPECT_EQ(cut.pose(time).matrix(), whole.pose(time + 2.0).matrix());
    EXPECT_EQ(cut.at(time).velocity, whole.at(time + 2.0).velocity);
  }
}

TEST(Motion, EachStyleDoesWhatItsNameSays) {
  const Scene scene = make_room(1);
  const auto fastest_turn = [&](const char* name) {
    const SplineTrajectory motion = make_trajectory(scene, motion_named(name), 20.0);
    double fastest = 0.0;
    for (double time = 0.0; time < 20.0; time += 0.01) {
      fastest = std::max(fastest, motion.at(time).angular_velocity.norm());
    }
    return fastest;
  };
  EXPECT_GT(fastest_turn("handheld"), 1.7);
  EXPECT_LT(fastest_turn("handheld"), 2.5);
  EXPECT_LT(fastest_turn("walk"), 1.5);
  EXPECT_LT(make_trajectory(scene, motion_named("drive"), 5.0).at(0.5).velocity.norm(), 1e-9)
      << "at rest before the start";
  EXPECT_NEAR(make_trajectory(scene, motion_named("moving-start"), 5.0).at(0.0).velocity.norm(),
              scene.speed, 0.1 * scene.speed);
  const SplineTrajectory stops = make_trajectory(scene, motion_named("stop-and-go"), 16.0);
  EXPECT_GT(stops.at(7.5).velocity.norm(), 0.5 * scene.speed);
  EXPECT_LT(stops.at(11.5).velocity.norm(), 1e-9);
  EXPECT_GT(stops.at(15.5).velocity.norm(), 0.5 * scene.speed);
  EXPECT_THROW(motion_named("fly"), UsageError);
}

TEST(Motion, RunWithInTheHandIsFastAndRough) {
  for (const char* name : {"room", "office", "mine"}) {
    const SplineTrajectory motion =
        make_trajectory(make_scene(name, 1), motion_named("fast-handheld"), 12.0);
    double fastest = 0.0;
    double hardest = 0.0;
    double turn = 0.0;
    for (double time = 0.0; time < 12.0; time += 0.005) {
      const MotionState state = motion.at(time);
      fastest = std::max(fastest, state.velocity.head<2>().norm());
      hardest = std::max(hardest, state.acceleration.norm());
      turn = std::max(turn, state.angular_velocity.norm());
    }
    EXPECT_NEAR(fastest, 3.0, 0.4) << name;
    EXPECT_GT(hardest, 13.0) << name;
    EXPECT_LT(hardest, 25.0) << name;
    EXPECT_GT(turn, 3.0) << name;
    EXPECT_LT(turn, 10.0) << name;
  }
}

TEST(Motion, WayThroughAWallIsTold) {
  Mesh mesh;
  add_block(mesh, {4.0, -5.0, 0.0}, {4.2, 5.0, 3.0}, Material::concrete);
  const RayScene still(mesh);
  // Ahead at 1 m/s, through both faces of the wall, which are one crossing.
  const auto ahead = [](double time) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << time, 0.3, 1.0;
    return pose;
  };
  const std::vector<Crossing> found = find_crossings(ahead, 10.0, still);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].time, 4.0, 0.03);
  EXPECT_LT((found[0].at - Vector3d(4.0, 0.3, 1.0)).norm(), 1e-6);
  EXPECT_TRUE(find_crossings(ahead, 3.9, still).empty());
  const auto carried = [&](double time) { return ahead(time < 2.0 ? time : time + 4.0); };
  EXPECT_TRUE(find_crossings(carried, 5.0, still).empty()) << "by another way";
}

TEST(Motion, NothingStandsInTheWayOfARoute) {
  for (const std::string& name : scene_names()) {
    const Scene scene = make_scene(name, 1);
    const RayScene still(scene.mesh);
    const double once = route_length(scene) / scene.speed + 4.0;
    const SplineTrajectory motion = make_trajectory(scene, motion_named("drive"), once);
    Vector3d last = motion.pose(0.0).translation();
    for (double time = 0.1; time < once; time += 0.1) {
      const Vector3d at = motion.pose(time).translation();
      EXPECT_GT(still.distance_to(at), 0.25) << name << " at " << time << " s";
      const Vector3d step = at - last;
      if (step.norm() > 1e-6) {
        EXPECT_FALSE(still.cast(last, step.normalized(), step.norm()))
            << name << " goes through something at " << time << " s, " << at.transpose();
      }
      last = at;
    }
    EXPECT_LT((last - motion.pose(0.0).translation()).norm(), 2.0 + 2.5 * scene.speed)
        << name << " is not closed";
  }
}

}  // namespace
}  // namespace adit
