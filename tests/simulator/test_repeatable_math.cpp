// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/repeatable_math.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/simulator/counter_random.hpp"

namespace adit {
namespace {

TEST(RepeatableMath, SineAndCosineAreThoseOfTheLibraryToTheLastDigits) {
  for (int i = -20000; i <= 20000; ++i) {
    const double angle = 0.01 * i + 1e-5 * i * i;
    const SinCos result = repeatable_sin_cos(angle);
    EXPECT_NEAR(result.sin, std::sin(angle), 1e-15 + 1e-19 * std::abs(angle)) << angle;
    EXPECT_NEAR(result.cos, std::cos(angle), 1e-15 + 1e-19 * std::abs(angle)) << angle;
  }
}

TEST(RepeatableMath, ArcTangentKnowsItsQuadrants) {
  for (int i = 0; i < 3600; ++i) {
    const double angle = -std::numbers::pi + 1e-3 + i * 0.001744;
    for (const double length : {1e-6, 1.0, 4e5}) {
      const double y = length * std::sin(angle);
      const double x = length * std::cos(angle);
      EXPECT_NEAR(repeatable_atan2(y, x), std::atan2(y, x), 1e-15) << angle;
    }
  }
  EXPECT_EQ(repeatable_atan2(0.0, 0.0), 0.0);
}

TEST(RepeatableMath, LogarithmAndExponential) {
  for (double x = 1e-300; x < 1e300; x *= 1.7) {
    EXPECT_NEAR(repeatable_log(x), std::log(x), 1e-15 * (1.0 + std::abs(std::log(x)))) << x;
  }
  for (double x = -690.0; x < 690.0; x += 0.37) {
    EXPECT_NEAR(repeatable_exp(x) / std::exp(x), 1.0, 1e-14) << x;
  }
  EXPECT_EQ(repeatable_exp(-1000.0), 0.0);
}

TEST(RepeatableMath, RotationsAreThoseOfTheLieGroup) {
  const CounterRandom random(3, RandomStream::scene);
  for (uint64_t i = 0; i < 300; ++i) {
    const double size = i % 3 == 0 ? 1e-9 : i % 3 == 1 ? 1e-4 : 1.2;
    const Eigen::Vector3d phi = size * random.gaussian_vector(i).cwiseMax(-1.4).cwiseMin(1.4);
    EXPECT_LT((repeatable_so3_exp(phi) - so3_exp(phi)).norm(), 1e-13);
    EXPECT_LT((repeatable_so3_log(so3_exp(phi)) - phi).norm(), 1e-9 * (1e-6 + phi.norm()) + 1e-15);
  }
}

TEST(RepeatableMath, YawPitchRollTurnInThatOrder) {
  const Eigen::Matrix3d expected = (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(-0.3, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  EXPECT_LT((rotation_from_yaw_pitch_roll(0.7, -0.3, 0.2) - expected).norm(), 1e-14);
}

TEST(CounterRandom, NumbersDependOnSeedStreamAndIndexAlone) {
  const CounterRandom random(7, RandomStream::range);
  EXPECT_EQ(random.bits(5), CounterRandom(7, RandomStream::range).bits(5));
  EXPECT_NE(random.bits(5), random.bits(6));
  EXPECT_NE(random.bits(5), CounterRandom(8, RandomStream::range).bits(5));
  EXPECT_NE(random.bits(5), CounterRandom(7, RandomStream::gnss).bits(5));
}

TEST(CounterRandom, GaussiansHaveTheMomentsOfGaussians) {
  const CounterRandom random(1, RandomStream::imu_noise);
  constexpr int kCount = 200000;
  double sum = 0.0;
  double squares = 0.0;
  double fourths = 0.0;
  double product = 0.0;
  double successive = 0.0;
  double last = 0.0;
  for (uint64_t i = 0; i < kCount; ++i) {
    const Eigen::Vector2d pair = random.gaussians(i);
    sum += pair.x();
    squares += pair.x() * pair.x();
    fourths += pair.x() * pair.x() * pair.x() * pair.x();
    product += pair.x() * pair.y();
    successive += pair.x() * last;
    last = pair.x();
  }
  // Four standard deviations of each estimate.
  EXPECT_NEAR(sum / kCount, 0.0, 0.009);
  EXPECT_NEAR(squares / kCount, 1.0, 0.0127);
  EXPECT_NEAR(fourths / kCount, 3.0, 0.088);
  EXPECT_NEAR(product / kCount, 0.0, 0.009);
  EXPECT_NEAR(successive / kCount, 0.0, 0.009);
}

}  // namespace
}  // namespace adit
