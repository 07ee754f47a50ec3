// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The loop on the device: steps, convergence, failure.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/alignment_scene.hpp"
#include "adit/benchmarks/verify/verify.hpp"
#include "adit/slam/registration/registration.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using test::AlignmentRun;
using test::AlignmentScene;
using test::DeviceCloud;

double distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm();
}
double angle(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return rotation_angle(a.linear().transpose() * b.linear());
}

bool is_finite(const test::DeviceOutcome& state) {
  const auto* numbers = reinterpret_cast<const float*>(&state.pose);
  return std::all_of(numbers, numbers + 12, [](float x) { return std::isfinite(x); }) &&
         std::all_of(std::begin(state.system), std::begin(state.system) + gpu::kSystemSize,
                     [](float x) { return std::isfinite(x); });
}

bool same_pose(const gpu::mat3x4& a, const gpu::mat3x4& b) {
  return std::memcmp(&a, &b, sizeof(a)) == 0;
}

// Nothing is left to do: what is recorded after this is skipped.
void expect_done(const test::DeviceOutcome& state) {
  EXPECT_EQ(state.phase, gpu::kPhaseDone);
  EXPECT_EQ(state.header.iterate.groups_x, 0U);
  EXPECT_EQ(state.ticket, 0U);
}

void expect_failed_at(const test::DeviceOutcome& state, const Eigen::Isometry3d& start) {
  expect_done(state);
  EXPECT_EQ(state.failed, 1U);
  EXPECT_EQ(state.converged, 0U);
  EXPECT_EQ(state.iterations, 0U);
  EXPECT_TRUE(is_finite(state));
  EXPECT_TRUE(same_pose(state.pose, to_device(start)));
}

class VgicpLoop : public test::DeviceTest {
 protected:
  static test::DeviceOutcome align(const AlignmentScene& scene,
                                   const std::vector<gpu::uvec4>& source,
                                   const Eigen::Isometry3d& start,
                                   const reference::AlignmentSettings& settings) {
    const DeviceCloud cloud(context(), source);
    AlignmentRun vgicp(context(), scene.kernels(), cloud, scene.map(), settings);
    vgicp.align(start);
    return vgicp.state();
  }
};

TEST_F(VgicpLoop, RecoversThePoseFromEveryOffsetAsTheTwinDoes) {
  for (const int points : {5'000, 30'000}) {
    const AlignmentScene scene(context(), test::street_alignment(points));
    const std::vector<reference::SurfacePoint> source = reference::decode(scene.source());
    // As far as float goes: of two that stop at a coarser step, one may take a step more, in which
    // a match changes.
    reference::AlignmentSettings settings = scene.settings();
    settings.translation_epsilon = 1e-5;
    settings.rotation_epsilon = 2e-6;
    for (const auto& [name, offset] : test::offsets()) {
      SCOPED_TRACE(std::to_string(points) + " points, " + name);
      const Eigen::Isometry3d start = retract(scene.T_target_source(), offset);
      const test::DeviceOutcome state = align(scene, scene.source(), start, settings);
      const reference::Alignment expected =
          reference::align(source, scene.target(), start, settings);
      expect_done(state);
      EXPECT_TRUE(is_finite(state));
      EXPECT_EQ(state.converged, 1U);
      EXPECT_EQ(state.failed, 0U);
      EXPECT_TRUE(expected.converged);
      const Eigen::Isometry3d pose = from_device(state.pose);
      // A point at a border may be matched by one and not by the other.
      EXPECT_LT(distance(pose, expected.pose), 2e-4);
      EXPECT_LT(angle(pose, expected.pose), 4e-5);
      EXPECT_NEAR(static_cast<double>(state.system[gpu::kInliersAt]),
                  static_cast<double>(expected.system.inliers),
                  0.003 * static_cast<double>(expected.system.inliers));
      EXPECT_NEAR(static_cast<double>(state.system[gpu::kCostAt]), expected.system.cost,
                  0.01 * expected.system.cost);
      // Truth: a single target sweep of 16 or 32 beams leaves rings on the ground, so that the
      // means of its voxels are not where those of the source are.
      EXPECT_LT(distance(pose, scene.T_target_source()), 0.03);
      EXPECT_LT(angle(pose, scene.T_target_source()), points < 20'000 ? 0.01 : 0.003);
      RecordProperty(
          std::to_string(points) + " " + name,
          "mm from the twin = " + std::to_string(1e3 * distance(pose, expected.pose)) +
              "\nmrad from the twin = " + std::to_string(1e3 * angle(pose, expected.pose)) +
              "\nmm from the truth = " +
              std::to_string(1e3 * distance(pose, scene.T_target_source())) +
              "\nmrad from the truth = " +
              std::to_string(1e3 * angle(pose, scene.T_target_source())) +
              "\niterations = " + std::to_string(state.iterations) +
              "\niterations of the twin = " + std::to_string(expected.iterations));
    }
  }
}

TEST_F(VgicpLoop, ReportsTheSystemAtTheFinalPose) {
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  const Eigen::Isometry3d start = retract(scene.T_target_source(), test::offsets().back().second);
  const DeviceCloud source(context(), scene.source());
  AlignmentRun vgicp(context(), scene.kernels(), source, scene.map(), scene.settings());
  vgicp.align(start);
  const test::DeviceOutcome aligned = vgicp.state();
  // Again from the final pose: from_device() rounds it onto SE(3), so not the same bits.
  vgicp.evaluate(from_device(aligned.pose));
  const test::Verdict verdict = test::verify_system(test::system_of(aligned), vgicp.state(), 1e-3);
  EXPECT_TRUE(verdict.passed()) << verdict.text();
}

TEST_F(VgicpLoop, StepsAreTheHostsRetraction) {
  // shaders/include/lie.glsl against slam/core/lie.hpp: one step, from the system that the device
  // itself reports. Large voxels and a start far from the truth give steps of a quarter radian.
  reference::AlignmentSettings settings{
      .d_max = 8.0, .translation_epsilon = 1e-9, .rotation_epsilon = 1e-9, .max_iterations = 1};
  const test::AlignmentCase street = test::street_alignment(5'000);
  test::AlignmentCase coarse = street;
  coarse.voxel_size = 8.0;
  const AlignmentScene fine_scene(context(), street);
  const AlignmentScene coarse_scene(context(), coarse);
  double largest = 0.0;
  for (const AlignmentScene* scene : {&fine_scene, &coarse_scene}) {
    for (const double yaw : {0.0, 1e-5, 1e-3, 0.02, 0.1, 0.3, 0.5, -0.5}) {
      SCOPED_TRACE(yaw);
      Vector6d offset;
      offset << 0.01, 0.02, 0.0, 0.3 * yaw, -0.2 * yaw, yaw;
      const Eigen::Isometry3d start = retract(scene->T_target_source(), offset);
      const DeviceCloud source(context(), scene->source());
      AlignmentRun vgicp(context(), scene->kernels(), source, scene->map(), settings);
      vgicp.evaluate(start);
      const Vector6d step = reference::step_of(test::system_of(vgicp.state()));
      vgicp.align(start);
      const test::DeviceOutcome state = vgicp.state();
      expect_done(state);
      EXPECT_EQ(state.iterations, 1U);
      EXPECT_EQ(state.converged, 0U);
      const Eigen::Isometry3d expected = reference::move(start, step);
      const Eigen::Isometry3d pose = from_device(state.pose);
      largest = std::max(largest, step.tail<3>().norm());
      // The solve in float32 of a system of condition up to 1e4, and a pose of float32.
      EXPECT_LT(angle(pose, expected), 1e-6 + 1e-4 * step.tail<3>().norm());
      EXPECT_LT(distance(pose, expected), 1e-5 + 1e-4 * step.norm());
    }
  }
  EXPECT_GT(largest, 0.1);
  RecordProperty("largest rotation of a step, rad", std::to_string(largest));
}

TEST_F(VgicpLoop, RotationStaysARotation) {
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  reference::AlignmentSettings settings = scene.settings();
  settings.translation_epsilon = 1e-12;  // never: two hundred products of rotations
  settings.rotation_epsilon = 1e-12;
  settings.max_iterations = 200;
  const test::DeviceOutcome state =
      align(scene, scene.source(), retract(scene.T_target_source(), test::offsets().back().second),
            settings);
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 3; ++i) {
    rotation.row(i) << state.pose.rows[i].x, state.pose.rows[i].y, state.pose.rows[i].z;
  }
  EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(),
            1e-6);
  EXPECT_GT(rotation.determinant(), 0.0);
}

TEST_F(VgicpLoop, TwoRunsGiveTheSameBytesAndLaterIterationsDoNothing) {
  const AlignmentScene scene(context(), test::street_alignment(30'000));
  const Eigen::Isometry3d start = retract(scene.T_target_source(), test::offsets().back().second);
  const test::DeviceOutcome first = align(scene, scene.source(), start, scene.settings());
  ASSERT_EQ(first.converged, 1U);
  ASSERT_LT(first.iterations, scene.settings().max_iterations);
  reference::AlignmentSettings longer = scene.settings();
  longer.max_iterations = 200;
  for (const reference::AlignmentSettings& settings : {scene.settings(), longer}) {
    const test::DeviceOutcome again = align(scene, scene.source(), start, settings);
    EXPECT_EQ(std::memcmp(&again, &first, sizeof(again)), 0);
  }
}

TEST_F(VgicpLoop, SaysSoWhenItHasNotConverged) {
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  reference::AlignmentSettings settings = scene.settings();
  settings.max_iterations = 2;
  const test::DeviceOutcome state =
      align(scene, scene.source(), retract(scene.T_target_source(), test::offsets().back().second),
            settings);
  expect_done(state);
  EXPECT_EQ(state.iterations, 2U);
  EXPECT_EQ(state.converged, 0U);
  EXPECT_EQ(state.failed, 0U);
  EXPECT_TRUE(is_finite(state));
}

TEST_F(VgicpLoop, FailsWithoutMatchesAndKeepsThePose) {
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  Eigen::Isometry3d far_away = scene.T_target_source();
  far_away.translation() += Eigen::Vector3d(500.0, -300.0, 100.0);
  const test::DeviceOutcome state = align(scene, scene.source(), far_away, scene.settings());
  expect_failed_at(state, far_away);
  EXPECT_EQ(state.system[gpu::kInliersAt], 0.0F);

  // Outside of what keys can name.
  far_away.translation() += Eigen::Vector3d(1e5, 1e5, 1e5);
  expect_failed_at(align(scene, scene.source(), far_away, scene.settings()), far_away);
}

TEST_F(VgicpLoop, FailsWithoutPointsOrMap) {
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  const Eigen::Isometry3d start = scene.T_target_source();
  expect_failed_at(align(scene, {}, start, scene.settings()), start);

  const AlignmentScene empty(context(), {}, scene.source(), start, 1.0, scene.settings());
  expect_failed_at(align(empty, scene.source(), start, scene.settings()), start);
}

TEST_F(VgicpLoop, FailsWithFewerMatchesThanUnknowns) {
  const AlignmentScene scene = test::random_surfaces_scene(context());
  const Eigen::Isometry3d start = scene.T_target_source();
  const std::vector<gpu::uvec4> certain = scene.certain_source(start, scene.settings().d_max);
  std::vector<gpu::uvec4> matched;
  for (const gpu::uvec4& packed : certain) {
    if (!reference::find_matches(reference::decode(std::vector{packed}), scene.target(), start,
                                 scene.settings().d_max)
             .empty()) {
      matched.push_back(packed);
    }
  }
  ASSERT_GT(matched.size(), 6U);
  matched.resize(5);
  const test::DeviceOutcome five = align(scene, matched, start, scene.settings());
  expect_failed_at(five, start);
  EXPECT_EQ(five.system[gpu::kInliersAt], 5.0F);
}

TEST_F(VgicpLoop, PoseIsNeverNanWhereRotationsCannotBeSeen) {
  // All points in one place: a turn about the ray to it changes nothing.
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  const std::vector<gpu::uvec4> cloud =
      scene.certain_source(scene.T_target_source(), scene.settings().d_max);
  for (const size_t i : {size_t{0}, cloud.size() / 3, cloud.size() - 1}) {
    gpu::uvec4 point = cloud[i];
    for (const bool on_an_axis : {false, true}) {
      if (on_an_axis) {
        point.y = point.z = 0;  // the sensor's axis
      }
      const test::DeviceOutcome state = align(scene, std::vector<gpu::uvec4>(100, point),
                                              scene.T_target_source(), scene.settings());
      expect_done(state);
      EXPECT_TRUE(is_finite(state));
    }
  }
}

}  // namespace
}  // namespace adit
