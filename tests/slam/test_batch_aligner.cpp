// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Batches of pairs: results, independence of the rest of the batch, and what cannot be aligned.
#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/registration/batch_aligner.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using test::Lidar;

constexpr std::array kMethods = {RegistrationMethod::vgicp, RegistrationMethod::ndt,
                                 RegistrationMethod::point_to_plane,
                                 RegistrationMethod::ndt_to_ndt};

PreprocessConfig preprocessing() {
  PreprocessConfig config;
  config.beam_spacing = Lidar{}.beam_spacing();
  config.surface_size = 1.0;
  return config;
}

AlignmentSettings settings_for(RegistrationMethod method) {
  AlignmentSettings settings;
  settings.method = method;
  settings.neighbours = 7;
  settings.d_max = 1.5;
  settings.min_overlap = 0.1;
  settings.translation_epsilon = 1e-3;
  settings.rotation_epsilon = 1e-4;
  settings.max_iterations = 60;
  return settings;
}

/// Sweeps of a street from places half a metre apart, as clouds and targets.
class BatchAlignerTest : public test::DeviceTest {
 protected:
  struct Street {
    std::vector<Eigen::Isometry3d> poses;
    std::vector<SurfaceCloud> clouds;
    std::vector<AlignmentTarget> targets;

    Eigen::Isometry3d truth(size_t target, size_t source) const {
      return poses[target].inverse() * poses[source];
    }
    AlignmentPair pair(size_t target, size_t source, const Vector6d& offset) const {
      AlignmentPair pair;
      pair.source = &clouds[source];
      pair.target = &targets[target];
      if (targets[target].method == RegistrationMethod::ndt_to_ndt) {
        pair.source_map = &targets[source];
      }
      pair.T_target_source = retract(truth(target, source), offset);
      return pair;
    }
  };

  static Street street(RegistrationMethod method, size_t count, std::vector<double> sizes = {1.0},
                       const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
    AlignmentClouds maker(context(), preprocessing());
    const test::World world = test::make_street(30.0);
    Street street;
    for (const StampedPose& pose : test::steady_drive(count, test::twist(0.5, 0.02))) {
      std::vector<Point> points = test::scan(world, pose, Lidar{.beams = 64}).points;
      std::erase_if(points, [](const Point& p) { return p.x == 0.0F && p.y == 0.0F; });
      for (Point& point : points) {
        point.x += static_cast<float>(shift.x());
        point.y += static_cast<float>(shift.y());
        point.z += static_cast<float>(shift.z());
      }
      street.poses.push_back(pose.pose * Eigen::Translation3d(-shift));
      street.clouds.push_back(maker.make_cloud(points, shift));
      street.targets.push_back(maker.make_target(street.clouds.back(), method, sizes));
    }
    return street;
  }

  static Vector6d offset(double metres, double radians) {
    Vector6d xi;
    xi << 0.6 * metres, -0.7 * metres, 0.4 * metres, -0.3 * radians, 0.4 * radians, 0.8 * radians;
    return xi;
  }
};

double metres_off(const RegistrationResult& result, const Eigen::Isometry3d& truth) {
  return (result.T_target_source.translation() - truth.translation()).norm();
}
double radians_off(const RegistrationResult& result, const Eigen::Isometry3d& truth) {
  return rotation_angle(truth.linear().transpose() * result.T_target_source.linear());
}

bool same_bits(const RegistrationResult& a, const RegistrationResult& b) {
  return std::memcmp(a.T_target_source.data(), b.T_target_source.data(), 16 * sizeof(double)) ==
             0 &&
         std::memcmp(a.hessian.data(), b.hessian.data(), 36 * sizeof(double)) == 0 &&
         a.status == b.status && a.inliers == b.inliers && a.iterations == b.iterations &&
         a.cost == b.cost;
}

TEST_F(BatchAlignerTest, EveryMethodFindsTheMotion) {
  for (const RegistrationMethod method : kMethods) {
    const Street scene = street(method, 2);
    BatchAligner aligner(context(), settings_for(method));
    const std::vector<RegistrationResult> results =
        aligner.align(std::vector{scene.pair(0, 1, offset(0.3, 0.03))});
    const RegistrationResult& result = results.at(0);
    const std::string name(to_string(method));
    EXPECT_TRUE(is_usable(result.status)) << name << ": " << to_string(result.status);
    EXPECT_LT(metres_off(result, scene.truth(0, 1)), 0.05) << name;
    EXPECT_LT(radians_off(result, scene.truth(0, 1)), 0.006) << name;
    RecordProperty(name, std::to_string(1e3 * metres_off(result, scene.truth(0, 1))) + " mm, " +
                             std::to_string(1e3 * radians_off(result, scene.truth(0, 1))) +
                             " mrad, " + std::to_string(result.iterations) + " iterations");
  }
}

// Small voxels alone find the motion from as far, with many more steps.
TEST_F(BatchAlignerTest, LevelsLeaveLittleToDoForTheFinest) {
  const Street fine = street(RegistrationMethod::vgicp, 2, {0.25});
  const Street levels = street(RegistrationMethod::vgicp, 2, {2.0, 1.0, 0.5, 0.25});
  AlignmentSettings settings = settings_for(RegistrationMethod::vgicp);
  settings.neighbours = 1;
  settings.d_max = 0.25;
  BatchAligner aligner(context(), settings);
  for (const double metres : {0.5, 1.0, 1.5, 2.0}) {
    SCOPED_TRACE(metres);
    const Vector6d far = offset(metres, 0.08 * metres);
    const RegistrationResult alone = aligner.align(std::vector{fine.pair(0, 1, far)}).at(0);
    const RegistrationResult last = aligner.align(std::vector{levels.pair(0, 1, far)}).at(0);
    EXPECT_LT(metres_off(alone, fine.truth(0, 1)), 0.05);
    EXPECT_LT(metres_off(last, levels.truth(0, 1)), 0.05);
    EXPECT_LT(2 * last.iterations, alone.iterations);
    RecordProperty(std::to_string(metres) + " m", std::to_string(alone.iterations) + " and " +
                                                      std::to_string(last.iterations) +
                                                      " iterations");
  }
}

TEST_F(BatchAlignerTest, APairsResultDoesNotDependOnItsBatch) {
  for (const RegistrationMethod method : kMethods) {
    const Street scene = street(method, 4, {2.0, 1.0});
    std::vector<AlignmentPair> pairs;
    for (size_t target = 0; target < 4; ++target) {
      for (size_t source = 0; source < 4; ++source) {
        pairs.push_back(
            scene.pair(target, source, offset(0.1 * static_cast<double>(source), 0.01)));
      }
    }
    BatchAligner aligner(context(), settings_for(method));
    const std::vector<RegistrationResult> together = aligner.align(pairs);
    const std::vector<RegistrationResult> again = aligner.align(pairs);
    ASSERT_EQ(together.size(), pairs.size());
    for (size_t i = 0; i < pairs.size(); ++i) {
      const RegistrationResult alone = aligner.align(std::vector{pairs[i]}).at(0);
      EXPECT_TRUE(same_bits(together[i], alone)) << to_string(method) << ", pair " << i;
      EXPECT_TRUE(same_bits(together[i], again[i])) << to_string(method) << ", pair " << i;
    }
  }
}

TEST_F(BatchAlignerTest, APairsResultDoesNotDependOnThePiecesItWasWorkedOffIn) {
  for (const RegistrationMethod method : kMethods) {
    const Street scene = street(method, 3, {2.0, 1.0});
    std::vector<AlignmentPair> pairs;
    for (size_t target = 0; target < 3; ++target) {
      for (size_t source = 0; source < 3; ++source) {
        pairs.push_back(
            scene.pair(target, source, offset(0.1 * static_cast<double>(source), 0.01)));
      }
    }
    pairs[4].T_target_source.translation().x() = std::numeric_limits<double>::quiet_NaN();
    const BatchAligner aligner(context(), settings_for(method));
    const std::vector<RegistrationResult> whole = aligner.align(pairs);
    for (const double budget : {0.0, 1.0, 50.0}) {  // ms; 0: one pass of one pair each
      BatchAlignment batch = aligner.begin(pairs);
      size_t pieces = 0;
      while (!batch.done()) {
        batch.submit(budget);
        if (pieces % 3 == 0) {
          batch.wait();  // or else the next submit() does
        }
        ++pieces;
      }
      const std::vector<RegistrationResult> found = batch.finish();
      ASSERT_EQ(found.size(), whole.size());
      for (size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].status, whole[i].status);
        EXPECT_TRUE(i == 4 || same_bits(found[i], whole[i]))
            << to_string(method) << ", pair " << i << ", pieces of " << budget << " ms";
      }
      EXPECT_TRUE(budget > 0.0 || pieces >= 8 * 4) << pieces;
      RecordProperty(std::string(to_string(method)) + " " + std::to_string(budget),
                     std::to_string(pieces) + " pieces");
    }
  }
}

TEST_F(BatchAlignerTest, ShuffledPointsMakeTheSameVoxelsAndNearlyTheSamePose) {
  const Street scene = street(RegistrationMethod::vgicp, 2);
  AlignmentClouds maker(context(), preprocessing());
  std::vector<Point> points =
      test::scan(test::make_street(30.0), test::steady_drive(2, test::twist(0.5, 0.02))[1],
                 Lidar{.beams = 64})
          .points;
  std::erase_if(points, [](const Point& p) { return p.x == 0.0F && p.y == 0.0F; });
  std::reverse(points.begin(), points.end());
  const SurfaceCloud reversed = maker.make_cloud(points);
  ASSERT_EQ(reversed.size, scene.clouds[1].size);
  BatchAligner aligner(context(), settings_for(RegistrationMethod::vgicp));
  AlignmentPair pair = scene.pair(0, 1, offset(0.2, 0.02));
  const RegistrationResult straight = aligner.align(std::vector{pair}).at(0);
  pair.source = &reversed;
  const RegistrationResult other = aligner.align(std::vector{pair}).at(0);
  EXPECT_EQ(straight.inliers, other.inliers);
  EXPECT_LT(metres_off(other, straight.T_target_source), 1e-4);
}

TEST_F(BatchAlignerTest, CloudsFarFromTheirOriginAreAlignedAsThoseNearIt) {
  const Eigen::Vector3d far(4.0e3, -7.0e3, 300.0);
  const Street scene = street(RegistrationMethod::vgicp, 2, {1.0}, far);
  BatchAligner aligner(context(), settings_for(RegistrationMethod::vgicp));
  const RegistrationResult result =
      aligner.align(std::vector{scene.pair(0, 1, Vector6d::Zero())}).at(0);
  EXPECT_EQ(result.status, RegistrationStatus::converged);
  // Where the sensor is, not kilometres away where a small turn is a long way; float32 holds such
  // coordinates to half a millimetre.
  const Eigen::Vector3d at = result.T_target_source * far;
  EXPECT_LT((at - scene.truth(0, 1) * far).norm(), 0.05);
}

TEST_F(BatchAlignerTest, WhatCannotBeAlignedSaysSoAndLeavesTheOthersAlone) {
  const Street scene = street(RegistrationMethod::vgicp, 2);
  AlignmentClouds maker(context(), preprocessing());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const SurfaceCloud empty = maker.make_cloud(std::vector<Point>(500, {nan, nan, nan, nan}));
  const AlignmentTarget nothing =
      maker.make_target(empty, RegistrationMethod::vgicp, std::vector{1.0});
  const SurfaceCloud one_place =
      maker.make_cloud(std::vector<Point>(1'000'000, {5.0F, 3.0F, 1.0F, 0.0F}));
  EXPECT_EQ(empty.size, 0U);
  EXPECT_EQ(one_place.size, 1U);

  std::vector<AlignmentPair> pairs(6, scene.pair(0, 1, offset(0.2, 0.02)));
  pairs[0].source = &empty;
  pairs[1].target = &nothing;
  pairs[2].source = &one_place;
  pairs[3].T_target_source.translation().x() = std::numeric_limits<double>::quiet_NaN();
  pairs[4].T_target_source.translation().x() += 400.0;
  BatchAligner aligner(context(), settings_for(RegistrationMethod::vgicp));
  const std::vector<RegistrationResult> results = aligner.align(pairs);
  EXPECT_EQ(results[0].status, RegistrationStatus::too_few_points);
  EXPECT_EQ(results[1].status, RegistrationStatus::too_few_points);
  EXPECT_EQ(results[2].status, RegistrationStatus::too_few_points);
  EXPECT_EQ(results[3].status, RegistrationStatus::diverged);
  EXPECT_EQ(results[4].status, RegistrationStatus::too_few_points);
  EXPECT_EQ(results[5].status, RegistrationStatus::converged);
  EXPECT_TRUE(same_bits(results[5], aligner.align(std::vector{pairs[5]}).at(0)));
  EXPECT_TRUE(aligner.align({}).empty());
}

TEST_F(BatchAlignerTest, TargetsOfAnotherMethodAreMistakes) {
  const Street scene = street(RegistrationMethod::ndt, 2);
  BatchAligner aligner(context(), settings_for(RegistrationMethod::vgicp));
  EXPECT_THROW(aligner.align(std::vector{scene.pair(0, 1, Vector6d::Zero())}), std::logic_error);
}

TEST_F(BatchAlignerTest, EvaluatingTellsTheRightPoseFromWrongOnes) {
  const Street scene = street(RegistrationMethod::ndt, 2);
  BatchAligner aligner(context(), settings_for(RegistrationMethod::ndt));
  std::vector<AlignmentPair> pairs;
  for (const double metres : {0.0, 0.3, 1.0}) {
    pairs.push_back(scene.pair(0, 1, offset(metres, 0.0)));
  }
  const std::vector<RegistrationResult> results = aligner.evaluate(pairs);
  EXPECT_LT(results[0].cost, results[1].cost);  // minus the score
  EXPECT_LT(results[1].cost, results[2].cost);
  EXPECT_EQ(results[0].iterations, 0);
  EXPECT_LT(metres_off(results[1], pairs[1].T_target_source), 1e-5);
}

TEST_F(BatchAlignerTest, AMapWithoutRoomForItsCloudIsRefused) {
  AlignmentClouds maker(context(), preprocessing());
  const SurfaceCloud cloud =
      maker.make_cloud(std::vector<Point>{{1.0F, 2.0F, 3.0F, 0.0F}, {90.0F, 0.0F, 0.0F, 0.0F}});
  EXPECT_THROW(maker.make_target(cloud, RegistrationMethod::vgicp, std::vector{0.05}),
               engine::Error);
}

}  // namespace
}  // namespace adit
