// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// One linearisation at a given pose: H, g, cost, matches.
#include <bit>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/alignment_scene.hpp"
#include "adit/benchmarks/verify/verify.hpp"
#include "adit/slam/registration/registration.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using reference::Match;
using reference::System;
using test::AlignmentRun;
using test::AlignmentScene;
using test::DeviceCloud;
using test::Verdict;

// Fraction of the natural scale of each sum. float32 places a point 60 m away within 4e-6 m and
// more, of errors e of centimetres: 1e-4; the inverse of a sum of covariances loses another 1e-4 of
// itself.
constexpr double kSystemBound = 3e-4;

class VgicpSystem : public test::DeviceTest {
 protected:
  // The device's system at the pose, of the source points that float32 cannot place otherwise than
  // double.
  struct Evaluation {
    test::DeviceOutcome state{};
    std::vector<reference::SurfacePoint> source{};
    std::vector<Match> matches{};
  };
  static Evaluation evaluate(const AlignmentScene& scene, const Eigen::Isometry3d& pose,
                             double d_max) {
    reference::AlignmentSettings settings = scene.settings();
    settings.d_max = d_max;
    const std::vector<gpu::uvec4> certain = scene.certain_source(pose, d_max);
    EXPECT_GE(static_cast<double>(certain.size()),
              0.95 * static_cast<double>(scene.source().size()));
    const DeviceCloud source(context(), certain);
    AlignmentRun vgicp(context(), scene.kernels(), source, scene.map(), settings);
    vgicp.evaluate(pose);
    Evaluation result{.state = vgicp.state(), .source = reference::decode(certain)};
    result.matches = reference::find_matches(result.source, scene.target(), pose, d_max);
    return result;
  }
};

// The system of residuals that are differentiated numerically: rows of J by central differences of
// e(xi), Omega and matches frozen. `moved` is the pose after a perturbation.
template <class Moved>
System numerical_system(const std::vector<Match>& matches,
                        const std::vector<reference::SurfacePoint>& source,
                        const Eigen::Isometry3d& pose, Moved&& moved) {
  constexpr double kStep = 1e-5;
  System system;
  for (const Match& match : matches) {
    const Eigen::Vector3d& a = source[match.source].p;
    const Eigen::Vector3d mean = match.error + pose * a;
    Eigen::Matrix<double, 3, 6> j;
    for (int k = 0; k < 6; ++k) {
      const Vector6d xi = kStep * Vector6d::Unit(k);
      j.col(k) = ((mean - moved(pose, xi) * a) - (mean - moved(pose, -xi) * a)) / (2.0 * kStep);
    }
    system.hessian += j.transpose() * match.information * j;
    system.gradient += j.transpose() * match.information * match.error;
    system.cost += match.error.dot(match.information * match.error);
    system.squared_distance += match.error.dot(match.target_constraint * match.error);
    system.inliers += 1;
  }
  return system;
}

TEST_F(VgicpSystem, IsTheTwinsAtEveryPose) {
  for (const int points : {5'000, 30'000}) {
    const AlignmentScene scene(context(), test::street_alignment(points));
    for (const auto& [name, offset] : test::offsets()) {
      for (const double d_max : {1.0, 0.2}) {
        SCOPED_TRACE(std::to_string(points) + " points, " + name + ", d_max " +
                     std::to_string(d_max));
        const Eigen::Isometry3d pose = retract(scene.T_target_source(), offset);
        const Evaluation found = evaluate(scene, pose, d_max);
        EXPECT_GT(found.matches.size(), 50U);
        const Verdict verdict =
            test::verify_system(reference::linearize(found.matches), found.state, kSystemBound);
        EXPECT_TRUE(verdict.passed()) << verdict.text();
        RecordProperty(std::to_string(points) + name, verdict.text());
      }
    }
  }
}

TEST_F(VgicpSystem, IsTheTwinsForAllClassesOfSurfaces) {
  const AlignmentScene scene = test::random_surfaces_scene(context());
  for (const auto& [name, offset] : test::offsets()) {
    SCOPED_TRACE(name);
    const Evaluation found = evaluate(scene, retract(scene.T_target_source(), offset), 0.7);
    EXPECT_GT(found.matches.size(), 50U);
    const Verdict verdict =
        test::verify_system(reference::linearize(found.matches), found.state, kSystemBound);
    EXPECT_TRUE(verdict.passed()) << verdict.text();
    RecordProperty(name, verdict.text());
  }
}

TEST_F(VgicpSystem, IsWhatNumericalDifferentiationGives) {
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  for (const auto& [name, offset] : test::offsets()) {
    SCOPED_TRACE(name);
    const Eigen::Isometry3d pose = retract(scene.T_target_source(), offset);
    const Evaluation found = evaluate(scene, pose, 1.0);
    const System numerical = numerical_system(found.matches, found.source, pose, reference::move);
    const Verdict verdict = test::verify_system(numerical, found.state, kSystemBound);
    EXPECT_TRUE(verdict.passed()) << verdict.text();

    // The gradient is that of half the cost, as a function of the pose.
    const auto cost = [&](const Vector6d& xi) {
      const Eigen::Isometry3d moved = reference::move(pose, xi);
      double sum = 0.0;
      for (const Match& match : found.matches) {
        const Eigen::Vector3d& a = found.source[match.source].p;
        const Eigen::Vector3d e = match.error + pose * a - moved * a;
        sum += e.dot(match.information * e);
      }
      return sum;
    };
    const System device = test::system_of(found.state);
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-4;
      const Vector6d xi = kStep * Vector6d::Unit(k);
      const double slope = 0.5 * (cost(xi) - cost(-xi)) / (2.0 * kStep);
      EXPECT_NEAR(device.gradient(k), slope,
                  kSystemBound * std::sqrt(device.hessian(k, k) * device.cost))
          << k;
    }
  }
}

TEST_F(VgicpSystem, HostTurnsItIntoTheBodysAxes) {
  const AlignmentScene scene(context(), test::street_alignment(5'000));
  Vector6d offset;
  offset << 0.1, -0.05, 0.02, 0.01, -0.02,
      0.6;  // far from the identity: a transposed rotation shows
  const Eigen::Isometry3d pose = retract(scene.T_target_source(), offset);
  const Evaluation found = evaluate(scene, pose, 1.0);
  const RegistrationResult result = read_registration(
      {found.state, found.state}, static_cast<int>(found.source.size()), 0.5, RegistrationConfig{});
  // xi on the right, as slam/core/lie.hpp retracts.
  const System expected = numerical_system(
      found.matches, found.source, pose,
      [](const Eigen::Isometry3d& at, const Vector6d& xi) { return retract(at, xi); });
  const Vector6d scale = expected.hessian.diagonal().cwiseSqrt();
  const Matrix6d difference =
      (result.hessian - expected.hessian).cwiseQuotient((scale * scale.transpose()).eval());
  EXPECT_LT(difference.cwiseAbs().maxCoeff(), kSystemBound);
  const Vector6d gradient_difference =
      (result.gradient - expected.gradient)
          .cwiseQuotient((scale * std::sqrt(expected.cost)).eval());
  EXPECT_LT(gradient_difference.cwiseAbs().maxCoeff(), kSystemBound);
  EXPECT_EQ(result.inliers, expected.inliers);
  EXPECT_NEAR(result.cost, expected.cost, kSystemBound * expected.cost);
  const double rms = std::sqrt(expected.squared_distance / static_cast<double>(expected.inliers));
  EXPECT_NEAR(result.residual_rms, rms, kSystemBound * rms);
  EXPECT_NEAR(result.overlap,
              static_cast<double>(expected.inliers) / static_cast<double>(found.source.size()),
              1e-12);
  EXPECT_LT((result.T_target_source.matrix() - pose.matrix()).cwiseAbs().maxCoeff(), 1e-5);
}

enum class Shows { front, back, front_edge_on, nothing };

/// A wall across x, two metres wide and high, at x (m); its front is seen from where x is greater.
std::vector<gpu::uvec4> wall(double x, Shows shows) {
  const uint32_t kind = shows == Shows::nothing ? 0U : (shows == Shows::front_edge_on ? 3U : 1U);
  const uint32_t u = shows == Shows::back ? 0U : 32766U;  // octahedral: along -x, along x
  const uint32_t surface = (kind << 30U) | (u << 15U) | 16383U;
  std::vector<gpu::uvec4> points;
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 20; ++k) {
      points.push_back({std::bit_cast<uint32_t>(static_cast<float>(x)),
                        std::bit_cast<uint32_t>(0.1F * static_cast<float>(i) + 0.03F),
                        std::bit_cast<uint32_t>(0.1F * static_cast<float>(k) + 0.03F), surface});
    }
  }
  return points;
}

// Both faces lie in the same voxels.
TEST_F(VgicpSystem, FacesOfAThinWallDoNotMatchEachOther) {
  const auto matches = [this](const std::vector<gpu::uvec4>& target,
                              const std::vector<gpu::uvec4>& source) {
    const AlignmentScene scene(context(), target, source, Eigen::Isometry3d::Identity(), 0.4, {});
    const Evaluation found = evaluate(scene, Eigen::Isometry3d::Identity(), 0.3);
    EXPECT_EQ(found.state.system[gpu::kInliersAt], static_cast<float>(found.matches.size()));
    return static_cast<double>(found.matches.size()) / static_cast<double>(source.size());
  };
  const std::vector<gpu::uvec4> front = wall(0.25, Shows::front);
  EXPECT_GE(matches(front, wall(0.25, Shows::front)), 0.95);
  EXPECT_GE(matches(front, wall(0.15, Shows::front)), 0.95) << "a wall that moved";
  EXPECT_EQ(matches(front, wall(0.15, Shows::back)), 0.0);
  EXPECT_GE(matches(front, wall(0.15, Shows::nothing)), 0.95);
  EXPECT_GE(matches(front, wall(0.15, Shows::front_edge_on)), 0.95);
  EXPECT_GE(matches(wall(0.25, Shows::front_edge_on), wall(0.15, Shows::back)), 0.95);
  // Where a map has both, their mean is inside the wall.
  std::vector<gpu::uvec4> both = front;
  const std::vector<gpu::uvec4> back = wall(0.15, Shows::back);
  both.insert(both.end(), back.begin(), back.end());
  EXPECT_EQ(matches(both, front), 0.0);
  EXPECT_EQ(matches(both, back), 0.0);
}

TEST_F(VgicpSystem, OrderOfThePointsIsRoundingOnly) {
  const AlignmentScene scene(context(), test::street_alignment(30'000));
  std::vector<gpu::uvec4> points = scene.source();
  const DeviceCloud source(context(), points);
  AlignmentRun vgicp(context(), scene.kernels(), source, scene.map(), scene.settings());
  vgicp.evaluate(scene.T_target_source());
  const System expected = test::system_of(vgicp.state());
  std::reverse(points.begin(), points.end());
  const DeviceCloud reversed(context(), points);
  AlignmentRun other(context(), scene.kernels(), reversed, scene.map(), scene.settings());
  other.evaluate(scene.T_target_source());
  const Verdict verdict = test::verify_system(expected, other.state(), 1e-5);
  EXPECT_TRUE(verdict.passed()) << verdict.text();
}

}  // namespace
}  // namespace adit
