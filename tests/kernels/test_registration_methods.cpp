// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Finished voxel maps, and one linearisation of every method, number of neighbours and robust
// kernel, against their double-precision twins.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/alignment_scene.hpp"
#include "adit/benchmarks/verify/registration_methods.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using reference::FinishedMap;
using reference::FullSystem;
using reference::Objective;
using reference::SourceItem;
using test::AlignmentScene;
using test::decode_target;
using test::kMethodGaussians;
using test::method_case;
using test::method_target;
using test::MethodCase;
using test::MethodEvaluation;
using test::VoxelMapRun;

constexpr double kMargin = 2e-4;  // voxels, as in AlignmentScene

class RegistrationMethods : public test::DeviceTest {};

TEST_F(RegistrationMethods, SumsAreTheTwins) {
  const AlignmentScene scene(context(), test::street_alignment(30'000));
  for (MethodCase& test : test::method_cases()) {
    SCOPED_TRACE(test.name);
    test.objective.viewpoint = Eigen::Vector3d(3.0, 1.0, 0.5);
    const engine::RegistrationKernels kernels(context(), test.objective.options);
    // From the raw source's neighbour: enough points a voxel for Gaussians.
    const VoxelMapRun target =
        method_target(context(), test.objective.options.method, scene.source());
    for (const size_t i : {size_t{0}, size_t{3}, size_t{6}}) {
      const auto [name, offset] = test::offsets()[i];
      SCOPED_TRACE(name);
      const MethodEvaluation found =
          test::evaluate_method(context(), scene.source(), kernels, target, test.objective,
                                retract(Eigen::Isometry3d::Identity(), offset));
      EXPECT_GT(found.twin.matches, 50);
      EXPECT_GT(found.items.size(), 100U);
      const test::Verdict verdict = test::verify_method(found);
      EXPECT_TRUE(verdict.passed()) << verdict.text();
    }
  }
}

// A software device may end loops that go on for long without a word: the same points a hundred
// times over must match a hundred times as often.
TEST_F(RegistrationMethods, EveryPointCountsHoweverManyThereAre) {
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  const MethodCase test = method_case("", gpu::kVgicp, 27);
  const engine::RegistrationKernels kernels(context(), test.objective.options);
  const VoxelMapRun target = method_target(context(), gpu::kVgicp, scene.source());
  constexpr size_t kTimes = 100;
  std::vector<gpu::uvec4> many;
  for (size_t i = 0; i < kTimes; ++i) {
    many.insert(many.end(), scene.source().begin(), scene.source().end());
  }
  const auto inliers_and_matches = [&](const std::vector<gpu::uvec4>& points) {
    const test::DeviceCloud source(context(), points);
    test::AlignmentRun run = test::method_run(context(), kernels, source, target, test.objective);
    run.evaluate(Eigen::Isometry3d::Identity());
    const test::DeviceOutcome found = run.state();
    return std::pair(found.system[gpu::kInliersAt], found.system[gpu::kMatchesAt]);
  };
  const auto [inliers, matches] = inliers_and_matches(scene.source());
  const auto [many_inliers, many_matches] = inliers_and_matches(many);
  EXPECT_GT(inliers, 2000.0F);
  EXPECT_EQ(many_inliers, kTimes * inliers);  // whole numbers below 2^24: exact
  EXPECT_EQ(many_matches, kTimes * matches);
}

TEST_F(RegistrationMethods, BackFacesAreSomeOfTheMatches) {
  const AlignmentScene scene(context(), test::street_alignment(30'000));
  const MethodCase test = method_case("", gpu::kVgicp, 1, gpu::kNoRobust, true);
  const engine::RegistrationKernels kernels(context(), test.objective.options);
  const VoxelMapRun target = method_target(context(), gpu::kVgicp, scene.source());
  Objective objective = test.objective;
  const auto inliers = [&](const Eigen::Vector3d& viewpoint) {
    objective.viewpoint = viewpoint;
    return test::evaluate_method(context(), scene.source(), kernels, target, objective,
                                 Eigen::Isometry3d::Identity())
        .device.system.inliers;
  };
  const int64_t from_the_sensor = inliers(Eigen::Vector3d::Zero());
  const int64_t from_behind_the_houses = inliers(Eigen::Vector3d(0.0, 60.0, 0.0));
  EXPECT_LT(from_behind_the_houses, from_the_sensor);
  EXPECT_GT(from_behind_the_houses, 0);
}

// With the weights that the kernels state, the gradient is that of the cost: of NDT's score itself,
// and of half the sum of rho(d^2).
TEST_F(RegistrationMethods, GradientsAreThoseOfTheCosts) {
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  const Eigen::Isometry3d pose = retract(Eigen::Isometry3d::Identity(), test::offsets()[5].second);
  for (const MethodCase& test : test::method_cases()) {
    if (test.objective.options.method == gpu::kNdtToNdt) {
      continue;  // its information turns with the pose; it is held fixed in each step
    }
    SCOPED_TRACE(test.name);
    Objective objective = test.objective;
    objective.d_max = 1e3;  // no match comes or goes
    objective.options.drop_back_faces = false;
    const VoxelMapRun map = method_target(context(), objective.options.method, scene.source());
    const FinishedMap target = decode_target(objective.options.method, map);
    std::vector<SourceItem> items;
    for (const gpu::uvec4& packed : scene.source()) {
      // Isotropic: information that does not turn with the pose.
      const SourceItem item{.p = reference::decode(packed).p};
      if (reference::place_of(pose * item.p, 1.0).certain(1e-3)) {
        items.push_back(item);
      }
    }
    const FullSystem here = reference::linearize(items, target, 1.0, pose, objective);
    const bool score = objective.options.method == gpu::kNdt;
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-6;
      const auto cost = [&](double sign) {
        const Eigen::Isometry3d moved = reference::move(pose, sign * kStep * Vector6d::Unit(k));
        return reference::linearize(items, target, 1.0, moved, objective).system.cost;
      };
      const double slope = (cost(1.0) - cost(-1.0)) / (2.0 * kStep);
      EXPECT_NEAR(here.system.gradient(k), score ? slope : 0.5 * slope,
                  1e-5 * std::sqrt(here.system.hessian(k, k) * here.weighted_cost));
    }
  }
}

// Information on translation (at = 0) or rotation (at = 3) when the other is free.
Eigen::Matrix3d marginal(const Matrix6d& h, int at) {
  const Eigen::Matrix3d coupling = h.block<3, 3>(at, 3 - at);
  return h.block<3, 3>(at, at) -
         coupling * h.block<3, 3>(3 - at, 3 - at).inverse() * coupling.transpose();
}

Eigen::Vector3d at_most_unit(const Eigen::Vector3d& v) {
  return v / std::max(v.norm(), 1.0);
}

// Sums of the shares that matches with agreeing normals have in the six directions.
std::array<double, 6> supports(const std::vector<SourceItem>& items, const FinishedMap& target,
                               const Eigen::Isometry3d& pose, double d_max,
                               const gpu::RegistrationState& state) {
  std::array<double, 6> sums{};
  for (const SourceItem& item : items) {
    const Eigen::Vector3d q = pose * item.p;
    const auto found = target.find(reference::place_of(q, 1.0).cell);
    if (found == target.end() || (found->second.mean - q).norm() > d_max) {
      continue;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(found->second.form);
    const Eigen::Vector3d target_normal = eigen.eigenvectors().col(2);
    const Eigen::Vector3d normal = pose.linear() * item.normal;
    if (eigen.eigenvalues()[2] <= 0.9 * std::max(eigen.eigenvalues().sum(), 1.0) ||
        std::abs(normal.dot(target_normal)) <= 0.94) {
      continue;
    }
    const Eigen::Vector3d ra = pose.linear() * item.p;
    for (size_t k = 0; k < 6; ++k) {
      const Eigen::Vector3d v(state.directions[k].x, state.directions[k].y, state.directions[k].z);
      const Eigen::Vector3d a = k < 3 ? normal : at_most_unit(ra.cross(normal));
      const Eigen::Vector3d b = k < 3 ? target_normal : at_most_unit(ra.cross(target_normal));
      const double share = std::min(std::abs(a.dot(v)), std::abs(b.dot(v)));
      sums[k] += share > 0.174 ? share : 0.0;
    }
  }
  return sums;
}

TEST_F(RegistrationMethods, DirectionsAndTheirSupportAreTheTwins) {
  for (const int points : {5'000, 30'000}) {
    SCOPED_TRACE(points);
    const AlignmentScene scene(context(), test::street_alignment(points));
    const MethodCase test = method_case("", gpu::kVgicp, 1);
    const VoxelMapRun target = method_target(context(), gpu::kVgicp, scene.source());
    const Eigen::Isometry3d pose =
        retract(Eigen::Isometry3d::Identity(), test::offsets()[3].second);
    const MethodEvaluation found = test::evaluate_method(context(), scene.source(), scene.kernels(),
                                                         target, test.objective, pose);
    const Matrix6d geometric = found.twin.system.hessian - 0.5 * found.twin.isotropic;
    const std::array<double, 6> expected =
        supports(found.items, found.target, pose, test.objective.d_max, found.state);
    for (const int at : {0, 3}) {
      const Eigen::Matrix3d information = marginal(geometric, at);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
      const Eigen::Matrix3d most = marginal(found.twin.isotropic, at);
      for (int k = 0; k < 3; ++k) {
        const gpu::vec4& direction = found.state.directions[at + k];
        const Eigen::Vector3d v(direction.x, direction.y, direction.z);
        EXPECT_NEAR(v.norm(), 1.0, 1e-5);
        // Schur complements in float32 of a system of condition 1e4.
        EXPECT_NEAR(static_cast<double>(direction.w), eigen.eigenvalues()[k],
                    1e-2 * eigen.eigenvalues()[k]);
        EXPECT_NEAR(v.dot(information * v), eigen.eigenvalues()[k], 1e-2 * eigen.eigenvalues()[k]);
        const double each = eigen.eigenvalues()[k] / v.dot(most * v);
        EXPECT_NEAR(static_cast<double>(found.state.support[at + k].y), each, 2e-2 * each);
        // A match at one of the thresholds may count here and not there.
        const double support = expected[static_cast<size_t>(at + k)];
        EXPECT_NEAR(static_cast<double>(found.state.support[at + k].x), support,
                    2.0 + 5e-3 * support);
        const auto matches = static_cast<double>(found.twin.matches);
        const double full = std::max(std::min(100.0, 0.02 * matches), 0.005 * matches);
        const double none = std::max(8.0, 1e-3 * matches);
        if (std::abs(support - none) > 2.5) {
          EXPECT_NEAR(static_cast<double>(found.state.share[at + k]),
                      support <= none ? 0.0 : std::min(1.0, support / full), 0.05);
        }
      }
    }
  }
}

TEST_F(RegistrationMethods, GaussiansAreTheTwins) {
  // Rooms with enough points a voxel; identical, collinear and lonely points.
  std::vector<Point> points = test::room(20'000, 5);
  points.insert(points.end(), 50, {20.3F, 0.4F, 0.6F, 0.0F});
  for (int i = 0; i < 40; ++i) {
    points.push_back({30.1F + 0.02F * static_cast<float>(i), 0.5F, 0.5F, 0.0F});
  }
  points.insert(points.end(), 5, {40.5F, 0.5F, 0.5F, 0.0F});  // one fewer than needed
  std::vector<gpu::uvec4> cloud;
  std::map<reference::Cell, std::vector<Eigen::Vector3d>> expected;
  for (const gpu::uvec4& packed : test::with_random_surfaces(points, 6)) {
    const Eigen::Vector3d p = reference::decode(packed).p;
    const reference::Place place = reference::place_of(p, 1.0);
    if (place.certain(kMargin)) {
      cloud.push_back(packed);
      expected[place.cell].push_back(p);
    }
  }
  const VoxelMapRun map = method_target(context(), gpu::kNdt, cloud);
  const FinishedMap found = reference::decode_finished(map.target_cells());
  size_t compared = 0;
  for (const auto& [at, members] : expected) {
    const auto voxel = found.find(at);
    if (members.size() < kMethodGaussians.min_points) {
      EXPECT_EQ(voxel, found.end());
      continue;
    }
    ASSERT_NE(voxel, found.end());
    const reference::FinishedVoxel twin = reference::gaussian_of(members, kMethodGaussians);
    EXPECT_EQ(voxel->second.count, twin.count);
    // Offsets are rounded down to 1/65536 voxel, and the mean to float32.
    EXPECT_LT((voxel->second.mean - twin.mean).norm(), 4e-5);
    // So are their products: 3/65536 of a square metre, and n / (n - 1) of it.
    EXPECT_LT((voxel->second.form - twin.form).cwiseAbs().maxCoeff(), 6e-5);
    ++compared;
  }
  EXPECT_EQ(found.size(), compared);
  EXPECT_GT(compared, 100U);
}

TEST_F(RegistrationMethods, PlanesAreWhatTheSurfacesOfAVoxelAgreeOn) {
  const AlignmentScene scene(context(), test::street_alignment(30'000));
  const VoxelMapRun map = method_target(context(), gpu::kPointToPlane, scene.source());
  const FinishedMap planes = reference::decode_finished(map.target_cells());
  size_t compared = 0;
  for (const auto& [at, voxel] : reference::decode(map.cells(), 1.0).voxels) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(voxel.constraint());
    const double largest = eigen.eigenvalues()[2];
    const double trace = eigen.eigenvalues().sum();
    const double margin = largest - 0.9 * std::max(trace, 0.5);
    if (std::abs(margin) < 1e-3) {
      continue;
    }
    const auto found = planes.find(at);
    ASSERT_EQ(found != planes.end(), margin > 0.0);
    if (margin > 0.0) {
      const Eigen::Vector3d n = eigen.eigenvectors().col(2);
      EXPECT_LT((found->second.form - n * n.transpose()).cwiseAbs().maxCoeff(), 1e-4);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100U);
}

}  // namespace
}  // namespace adit
