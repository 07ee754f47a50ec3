// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/rotation_comparison.hpp"

#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/frame_tree.hpp"
#include "adit/slam/core/lie.hpp"
#include "adit/tools/inspection/rotation_profile.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

/// rad/s in the range sensor's axes, at a time in s.
using Rate = std::function<Eigen::Vector3d(double)>;

Eigen::Vector3d lively(double t) {
  return {0.3 * std::sin(1.3 * t), 0.2 * std::cos(2.1 * t), 0.5 * std::sin(0.7 * t + 1.0)};
}
Eigen::Vector3d yawing(double t) {
  return {0.0, 0.0, 0.5 * std::sin(0.7 * t) + 0.2 * std::sin(2.0 * t)};
}

struct Sensors {
  std::vector<RotationInterval> rotations;
  std::vector<ImuSample> gyroscope;
};

/// Twenty seconds: rotations every 0.1 s, rates at 200 Hz, whose times are late by `offset` (s).
Sensors sense(const Rate& rate, const Eigen::Matrix3d& R_range_gyro, double offset, double noise,
              uint64_t seed = 5) {
  Sensors sensors;
  Random random(seed);
  const auto disturbed = [&](const Eigen::Vector3d& v, double sigma) -> Eigen::Vector3d {
    return v + sigma * Eigen::Vector3d(random.gaussian(), random.gaussian(), random.gaussian());
  };
  for (int i = 0; i < 200; ++i) {
    Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
    for (int k = 0; k < 100; ++k) {
      turned = turned * so3_exp(1e-3 * rate(0.1 * i + 1e-3 * (k + 0.5)));
    }
    sensors.rotations.push_back({Nanoseconds(100000000LL * i), Nanoseconds(100000000LL * (i + 1)),
                                 disturbed(so3_log(turned), noise)});
  }
  for (int i = -400; i < 4400; ++i) {
    const double t = 0.005 * i;
    const auto stamp = Nanoseconds(static_cast<int64_t>(std::llround(1e9 * (t + offset))));
    const Eigen::Vector3d bias(0.01, -0.02, 0.005);
    sensors.gyroscope.push_back(
        {.stamp = stamp,
         .angular_velocity = disturbed(R_range_gyro.transpose() * rate(t) + bias, noise)});
  }
  return sensors;
}

TEST(RotationComparison, FindsOffsetAndMountingDespiteBiasAndNoise) {
  const Eigen::Matrix3d R = so3_exp({1.0, -0.7, 2.0});
  for (const double offset : {0.0, 0.1, -0.4, 0.0137}) {
    const Sensors s = sense(lively, R, offset, 0.002);
    const auto found =
        compare_rotations(s.rotations, s.gyroscope, Eigen::Matrix3d::Identity(), 0.5);
    ASSERT_TRUE(found) << offset;
    EXPECT_LT(found->offset_sigma, 0.004);
    EXPECT_NEAR(found->offset, offset, 4.0 * found->offset_sigma);
    EXPECT_GT(found->correlation, 0.99);
    const Eigen::Vector3d error = so3_log(R.transpose() * found->R_range_gyro);
    EXPECT_LT(error.norm(), 0.02);
    EXPECT_TRUE(found->mounting_sigma.allFinite());
  }
}

TEST(RotationComparison, StandardDeviationsArePredicted) {
  double squares = 0.0;
  int count = 0;
  for (int seed = 0; seed < 40; ++seed) {
    // Another stretch of the same motion has other noise.
    const auto shifted = [&](double t) { return lively(t + 3.7 * seed); };
    const Sensors s = sense(shifted, Eigen::Matrix3d::Identity(), 0.02, 0.003);
    const auto found =
        compare_rotations(s.rotations, s.gyroscope, Eigen::Matrix3d::Identity(), 0.1);
    ASSERT_TRUE(found);
    squares += std::pow((found->offset - 0.02) / found->offset_sigma, 2);
    ++count;
  }
  EXPECT_GT(squares / count, 0.2);
  EXPECT_LT(squares / count, 3.0);
}

TEST(RotationComparison, TurningAboutOneAxisTellsTwoAnglesOfTheMounting) {
  const Eigen::Matrix3d expected = so3_exp({0.0, 0.0, 0.8});
  const Sensors s = sense(yawing, Eigen::Matrix3d::Identity(), 0.0, 0.001);
  const auto found = compare_rotations(s.rotations, s.gyroscope, expected, 0.5);
  ASSERT_TRUE(found);
  EXPECT_LT(found->misalignment, 0.02) << "about z nothing contradicts what is expected";
  EXPECT_TRUE(std::isfinite(found->mounting_sigma.x()));
  EXPECT_TRUE(std::isfinite(found->mounting_sigma.y()));
  EXPECT_FALSE(std::isfinite(found->mounting_sigma.z()));
  const Eigen::Matrix3d tilted = so3_exp({0.3, 0.0, 0.0});
  EXPECT_NEAR(compare_rotations(s.rotations, s.gyroscope, tilted, 0.5)->misalignment, 0.3, 0.02);
}

TEST(RotationComparison, NothingIsSaidOfAnglesThatTheMotionHides) {
  // Rolling and pitching by as much as the noise of a turn, which tells nothing of the yaw.
  const Rate swaying = [](double t) {
    return Eigen::Vector3d(0.04 * std::sin(3.0 * t), 0.03 * std::cos(4.0 * t), yawing(t).z());
  };
  const Eigen::Matrix3d expected = so3_exp({0.0, 0.0, 0.5});
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    for (const double roll : {0.0, 0.3, 3.0}) {
      const Sensors s = sense(swaying, so3_exp({roll, 0.0, 0.0}) * expected, 0.0, 0.006, seed);
      const auto found = compare_rotations(s.rotations, s.gyroscope, expected, 0.2);
      ASSERT_TRUE(found) << seed;
      EXPECT_EQ(unobserved_axes(*found), (std::array{false, false, true})) << seed;
      EXPECT_NEAR(found->misalignment, roll, 0.03) << seed;
    }
  }
}

TEST(RotationComparison, NothingWithoutCommonMotionOrTooLittleOfIt) {
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Sensors still =
      sense([](double) { return Eigen::Vector3d::Zero().eval(); }, identity, 0.0, 0.002);
  EXPECT_FALSE(compare_rotations(still.rotations, still.gyroscope, identity, 0.5));
  Sensors other = sense(lively, identity, 0.0, 0.002);
  other.gyroscope =
      sense([](double t) { return lively(3.0 * t + 50.0); }, identity, 0.0, 0.002).gyroscope;
  EXPECT_FALSE(compare_rotations(other.rotations, other.gyroscope, identity, 0.5));
  const Sensors good = sense(lively, identity, 0.0, 0.002);
  EXPECT_FALSE(
      compare_rotations(std::span(good.rotations).first(19), good.gyroscope, identity, 0.5));
  EXPECT_FALSE(compare_rotations({}, good.gyroscope, identity, 0.5));
  EXPECT_FALSE(compare_rotations(good.rotations, {}, identity, 0.5));
}

TEST(RotationProfile, TheLiveliestStretchIsWhereRatesChange) {
  RotationProfile profile;
  EXPECT_FALSE(profile.liveliest(std::chrono::seconds(20)));
  for (int i = 0; i < 1000; ++i) {  // 100 s; from 40 to 50 it sways, else it turns steadily
    const double t = 0.1 * i;
    const double rate = t > 40.0 && t < 50.0 ? std::sin(2.0 * t) : 0.1;
    profile.add(Nanoseconds(100000000LL * i), {0.0, 0.0, rate});
  }
  profile.add(Nanoseconds(0), {0.0, 0.0, std::nan("")});
  const TimeSpan ten = profile.liveliest(std::chrono::seconds(12)).value();
  EXPECT_LE(ten.begin, std::chrono::seconds(40));
  EXPECT_GE(ten.end, std::chrono::milliseconds(49900));
  EXPECT_EQ(ten.end - ten.begin, std::chrono::seconds(12) - Nanoseconds(1));
}

TEST(FrameTree, MountingsFollowTheChainToItsRoot) {
  FrameTree tree;
  const auto add = [&](const char* parent, const char* child, double x) {
    StaticTransform transform{parent, child, Eigen::Isometry3d::Identity()};
    transform.T_parent_child.translation().x() = x;
    tree.add(transform);
  };
  add("base", "mast", 1.0);
  add("mast", "/lidar", 2.0);
  add("base", "imu", 0.5);
  add("elsewhere", "camera", 7.0);
  EXPECT_EQ(tree.mounting("lidar").root, "base");
  EXPECT_DOUBLE_EQ(tree.mounting("lidar").T_root_frame.translation().x(), 3.0);
  EXPECT_DOUBLE_EQ(tree.transform("lidar", "imu")->translation().x(), -2.5);
  EXPECT_FALSE(tree.transform("lidar", "camera"));
  EXPECT_TRUE(tree.knows("base"));
  EXPECT_FALSE(tree.knows("radar"));
  add("lidar", "base", 1.0);
  EXPECT_EQ(tree.ignored().size(), 1U) << "a transform that closes a loop is reported";
  EXPECT_TRUE(tree.conflict("lidar", "imu")) << "the shortest chain counts, and another disagrees";
}

}  // namespace
}  // namespace adit
