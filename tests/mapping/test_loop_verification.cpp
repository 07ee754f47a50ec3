// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/loop_verification.hpp"

#include <map>

#include <gtest/gtest.h>

#include "adit/slam/submaps/free_space.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

test::Lidar lidar() {
  return {.beams = 64, .columns = 480, .lowest = -0.5, .highest = 0.5};
}

/// A submap of what the lidar sees from three places 0.5 m apart along x, the first at (x, y).
FrozenSubmap submap_at(engine::Context& context, const test::World& world, double x, double y,
                       double yaw, uint64_t seed) {
  Config config = test::submap_config();
  config.preprocess.beam_spacing = lidar().beam_spacing();
  SubmapBuilder builder(context, config.preprocess, config.mapping.r_submap);
  StampedPose first;
  first.pose.translation() = Eigen::Vector3d(x, y, 1.7);
  first.pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    StampedPose pose = first;
    pose.stamp = Nanoseconds(1'000'000 * (static_cast<int64_t>(seed) * 10 + i));
    pose.pose = first.pose * Eigen::Translation3d(0.5 * i, 0.0, 0.0);
    const std::vector<Point> points = test::returns(test::scan(world, pose, lidar()));
    builder.add({.stamp = pose.stamp,
                 .T_odom_lidar = first.pose.inverse() * pose.pose,
                 .cloud = points,
                 .gravity_odom = Eigen::Vector3d(0.0, 0.0, -9.81)});
  }
  return builder.freeze(config.preprocess.beam_spacing);
}

Matrix6d known_to(double metres, double radians) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(metres * metres),
      Eigen::Vector3d::Constant(radians * radians);
  return variances.asDiagonal();
}

Eigen::Isometry3d pose(double x, double y, double yaw) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = Eigen::Vector3d(x, y, 0.0);
  result.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return result;
}

/// Two walls and nothing else, for hundreds of metres.
test::World tunnel() {
  test::World world;
  world.blocks.push_back({{-300.0, 3.0, 0.0}, {300.0, 5.0, 6.0}});
  world.blocks.push_back({{-300.0, -5.0, 0.0}, {300.0, -3.0, 6.0}});
  return world;
}

/// A corridor with a ceiling, and a pillar at both walls every 1.5 m.
constexpr double kPeriod = 1.5;
test::World pillars() {
  test::World world{.blocks = {{{-200.0, -3.5, 0.0}, {200.0, -2.5, 4.0}},
                               {{-200.0, 2.5, 0.0}, {200.0, 3.5, 4.0}},
                               {{-200.0, -3.5, 4.0}, {200.0, 3.5, 5.0}}},
                    .poles = {}};
  for (int i = -60; i < 60; ++i) {
    for (const double y : {-2.5, 2.2}) {
      world.blocks.push_back({{kPeriod * i, y, 0.0}, {kPeriod * i + 0.4, y + 0.3, 4.0}});
    }
  }
  return world;
}

test::World room() {
  return {.blocks = {{{-7.0, -5.0, 0.0}, {-6.0, 5.0, 3.0}},
                     {{6.0, -5.0, 0.0}, {7.0, 5.0, 3.0}},
                     {{-6.0, -5.0, 0.0}, {6.0, -4.0, 3.0}},
                     {{-6.0, 4.0, 0.0}, {6.0, 5.0, 3.0}},
                     {{-4.0, -2.0, 0.0}, {-3.0, -1.0, 1.0}},
                     {{1.0, 1.5, 0.0}, {2.5, 2.5, 2.0}}},
          .poles = {}};
}

class LoopVerifierTest : public test::DeviceTest {
 protected:
  static LoopVerification ask(const KeyframeSubmap& from, const KeyframeSubmap& to,
                              const Eigen::Isometry3d& guess, const Matrix6d& known,
                              double gate = kExpectedGate) {
    LoopVerifier verifier(context(), test::submap_config());
    const SurfaceCloud cloud = make_surface_cloud(context(), to);
    const LoopQuestion question{
        .from = &from, .T_from_to = guess, .covariance = known, .gate = gate};
    return verifier.verify(to, cloud, std::span(&question, 1), 0.05).front();
  }
};

TEST_F(LoopVerifierTest, ThePlaceSeenAgainFromTheOtherDirectionIsBorneOut) {
  const FrozenSubmap from = submap_at(context(), room(), -1.5, 0.5, 0.0, 1);
  const FrozenSubmap to = submap_at(context(), room(), 0.5, 1.5, 3.1, 2);
  const Eigen::Isometry3d truth = pose(2.0, 1.0, 3.1);
  const LoopVerification verdict =
      ask(from.submap, to.submap, truth * pose(0.8, -0.6, 0.03), known_to(0.7, 0.03));
  EXPECT_EQ(verdict.reason, LoopReason::none) << to_string(verdict.reason) << verdict.figure;
  const Eigen::Isometry3d off = truth.inverse() * verdict.T_from_to;
  EXPECT_LT(off.translation().norm(), 0.06);
  EXPECT_LT(rotation_angle(off.linear()), 0.006);
  EXPECT_NEAR(verdict.correction, 1.0, 0.15);
  EXPECT_GT(verdict.overlap, 0.5);
  EXPECT_LT(verdict.through, 0.05);
  const Vector6d error = se3_log(off);
  EXPECT_LT(error.dot(verdict.covariance.inverse() * error), 16.81);
}

TEST_F(LoopVerifierTest, AnotherStreetIsRefused) {
  const FrozenSubmap from = submap_at(context(), test::make_street(60.0, 1), 20.0, 0.0, 0.0, 1);
  const FrozenSubmap to = submap_at(context(), test::make_street(60.0, 9), 20.0, 0.0, 0.0, 2);
  const LoopVerification verdict =
      ask(from.submap, to.submap, pose(0.0, 0.0, 0.0), known_to(1.0, 0.05));
  EXPECT_NE(verdict.reason, LoopReason::none);
}

TEST_F(LoopVerifierTest, ATrueMatchFarFromWhereTheGraphHasItIsBeyondTheGate) {
  const test::World street = test::make_street(60.0);
  const FrozenSubmap from = submap_at(context(), street, 20.0, 0.0, 0.0, 1);
  const FrozenSubmap to = submap_at(context(), street, 21.0, 0.0, 0.0, 2);
  const LoopVerification verdict =
      ask(from.submap, to.submap, pose(1.9, 0.0, 0.0), known_to(0.05, 0.005));
  EXPECT_EQ(verdict.reason, LoopReason::beyond_gate) << to_string(verdict.reason);
  EXPECT_GT(verdict.figure, 16.81);
  EXPECT_FALSE(verdict.expected);
  const LoopVerification drifted =
      ask(from.submap, to.submap, pose(1.9, 0.0, 0.0), known_to(0.05, 0.005), 1e6);
  EXPECT_EQ(drifted.reason, LoopReason::none) << "where more may have drifted, a vote decides";
  EXPECT_FALSE(drifted.expected);
}

TEST_F(LoopVerifierTest, ASmoothTunnelIsDegenerate) {
  const FrozenSubmap from = submap_at(context(), tunnel(), 0.0, 0.0, 0.0, 1);
  const FrozenSubmap to = submap_at(context(), tunnel(), 40.0, 0.3, 0.0, 2);
  const LoopVerification verdict =
      ask(from.submap, to.submap, pose(0.0, 0.0, 0.0), known_to(1.0, 0.03));
  EXPECT_EQ(verdict.reason, LoopReason::degenerate) << to_string(verdict.reason);
}

TEST_F(LoopVerifierTest, PillarsThatRepeatAreAmbiguous) {
  const FrozenSubmap from = submap_at(context(), pillars(), 0.2, 0.1, 0.0, 1);
  const FrozenSubmap to = submap_at(context(), pillars(), 10.0 * kPeriod + 0.4, 0.1, 0.0, 2);
  const LoopVerification verdict =
      ask(from.submap, to.submap, pose(0.0, 0.0, 0.0), known_to(0.7, 0.03));
  EXPECT_EQ(verdict.reason, LoopReason::ambiguous)
      << to_string(verdict.reason) << " at " << verdict.T_from_to.translation().transpose();
  EXPECT_NEAR(std::remainder(verdict.figure, kPeriod), 0.0, 0.1);
}

TEST_F(LoopVerifierTest, APairDoesNotDependOnItsBatch) {
  const test::World street = test::make_street(60.0);
  const FrozenSubmap near = submap_at(context(), street, 20.0, 0.0, 0.0, 1);
  const FrozenSubmap far = submap_at(context(), street, 35.0, 0.0, 0.0, 2);
  const FrozenSubmap to = submap_at(context(), street, 21.0, 0.5, 0.2, 3);
  LoopVerifier verifier(context(), test::submap_config());
  const SurfaceCloud cloud = make_surface_cloud(context(), to.submap);
  const std::array questions = {LoopQuestion{.from = &far.submap,
                                             .T_from_to = pose(-14.0, 0.5, 0.2),
                                             .covariance = known_to(1.0, 0.05)},
                                LoopQuestion{.from = &near.submap,
                                             .T_from_to = pose(1.3, 0.5, 0.2),
                                             .covariance = known_to(1.0, 0.05)}};
  const auto both = verifier.verify(to.submap, cloud, questions, 0.05);
  const auto alone = verifier.verify(to.submap, cloud, std::span(questions).last(1), 0.05);
  EXPECT_EQ(both[1].T_from_to.matrix(), alone[0].T_from_to.matrix());
  EXPECT_EQ(both[1].reason, alone[0].reason);
  EXPECT_EQ(both[1].through, alone[0].through);
}

/// Points of a wall across the view, `x` m ahead.
KeyframeSubmap wall_at(double x, double from_y, double to_y) {
  KeyframeSubmap submap;
  for (double y = from_y; y <= to_y; y += 0.1) {
    for (double z = -2.0; z <= 2.0; z += 0.1) {
      const auto steps = [](double metres) {
        return static_cast<int32_t>(std::lround(metres * kSubmapSteps));
      };
      submap.points.push_back({.place = {steps(x), steps(y), steps(z)}});
    }
  }
  return submap;
}

TEST(FreeSpace, AWallInFrontOfWhatIsSeenIsSeenThroughAndOneBehindItIsNot) {
  const KeyframeSubmap far = wall_at(10.0, -6.0, 6.0);
  const RangeImage image(far);
  const Eigen::Isometry3d same = Eigen::Isometry3d::Identity();
  EXPECT_EQ(seen_through(image, far, same), 0.0);
  EXPECT_GT(seen_through(image, wall_at(5.0, -2.0, 2.0), same), 0.6);
  EXPECT_EQ(seen_through(image, wall_at(15.0, -6.0, 6.0), same), 0.0) << "hidden, not absent";
  EXPECT_EQ(seen_through(image, wall_at(-5.0, -2.0, 2.0), same), 0.0) << "nothing is known there";
  Eigen::Isometry3d back = same;
  back.translation().x() = -5.0;
  EXPECT_GT(seen_through(image, wall_at(10.0, -2.0, 2.0), back), 0.6) << "moved, too";
  EXPECT_EQ(seen_through(image, wall_at(9.7, -6.0, 6.0), same), 0.0) << "within what poses err by";
}

}  // namespace
}  // namespace adit
