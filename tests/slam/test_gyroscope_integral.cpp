// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/gyroscope_integral.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace adit {
namespace {

const Eigen::Vector3d kTurnRate(0.2, -0.1, 0.05);
const Eigen::Vector3d kAcceleration(0.3, 0.2, -0.4);

/// Of a rate that grows evenly the interpolation is exact.
Eigen::Vector3d angle(double t) {
  return t * kTurnRate + 0.5 * t * t * kAcceleration;
}

/// Integral of the angle from 0 on.
Eigen::Vector3d sum(double t) {
  return 0.5 * t * t * kTurnRate + t * t * t / 6.0 * kAcceleration;
}

GyroscopeIntegral integral_of(const std::vector<double>& times) {
  std::vector<ImuSample> samples;
  for (const double t : times) {
    samples.push_back({.stamp = nanoseconds(t), .angular_velocity = kTurnRate + t * kAcceleration});
  }
  return {samples, Nanoseconds(0)};
}

TEST(GyroscopeIntegral, IsExactForAnEvenlyGrowingRateHoweverItIsSampled) {
  const GyroscopeIntegral integral = integral_of({0.0, 0.03, 0.04, 0.1, 0.16, 0.2, 0.29});
  for (const double t : {0.0, 0.035, 0.1, 0.12, 0.2}) {
    EXPECT_TRUE(integral.angle(t, 0.0).isApprox(angle(t), 1e-12) || t == 0.0) << t;
    EXPECT_TRUE(integral.angle_rate(t, 0.0).isApprox(kTurnRate + t * kAcceleration, 1e-12)) << t;
    for (const double span : {0.02, 0.05, 0.08}) {
      EXPECT_LT((integral.angle(t, span) - (sum(t + span) - sum(t)) / span).norm(), 1e-12)
          << t << " " << span;
    }
  }
}

TEST(GyroscopeIntegral, CoversWhatHasReadingsWithoutALongGap) {
  const GyroscopeIntegral integral = integral_of({0.0, 0.05, 0.3, 0.35});
  EXPECT_TRUE(integral.covers(0.0, 0.05));
  EXPECT_FALSE(integral.covers(0.04, 0.1)) << "a quarter of a second without a reading";
  EXPECT_TRUE(integral.covers(0.3, 0.35));
  EXPECT_FALSE(integral.covers(0.3, 0.36));
}

}  // namespace
}  // namespace adit
