// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/topics/imu_timeline.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

const Eigen::Vector3d kBias(0.004, -0.003, 0.002);
const Eigen::Vector3d kUp(0.5, 0.0, 9.79);

/// 200 Hz; what it turns by (rad/s about z) at a time, beside bias, gravity and noise.
template <class Rate>
ImuTimeline readings(double duration, Rate&& rate) {
  Random random(3);
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * random.gaussian(), sigma * random.gaussian(),
                           sigma * random.gaussian());
  };
  ImuTimeline timeline;
  for (int i = 0; i < static_cast<int>(200.0 * duration); ++i) {
    const double t = 0.005 * i;
    ImuSample sample;
    sample.stamp = std::chrono::milliseconds(5LL * i);
    sample.angular_velocity = kBias + Eigen::Vector3d(0.0, 0.0, rate(t)) + noise(0.002);
    sample.linear_acceleration = kUp + noise(0.05);
    timeline.add(sample.stamp, one_reading(sample));
  }
  return timeline;
}

TEST(ImuTimeline, FindsWhenTheSensorWasAtRestAndWhatItReadThen) {
  const auto found = rest_stretches(readings(
      9.0, [](double t) { return t > 3.0 && t < 7.0 ? 0.5 * std::sin(3.0 * t) + 0.1 : 0.0; }));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].begin, 0.0, 1e-9);
  EXPECT_NEAR(found[0].end, 3.0, 0.11);
  EXPECT_NEAR(found[1].begin, 7.0, 0.11);
  EXPECT_NEAR(found[1].end, 9.0, 1e-9);
  for (const RestStretch& one : found) {
    EXPECT_LT((one.gyro_bias - kBias).norm(), 1e-3);
    EXPECT_LT((one.acceleration - kUp).norm(), 0.02);
  }
}

TEST(ImuTimeline, WhoTurnsOrStandsForLessThanASecondIsNotAtRest) {
  EXPECT_TRUE(rest_stretches(readings(10.0, [](double) { return 0.3; })).empty());
  EXPECT_TRUE(rest_stretches(readings(10.0, [](double t) {
                return std::fmod(t, 1.0) < 0.8 ? 0.0 : 0.3;
              })).empty());
}

TEST(ImuTimeline, StaysAsSmallForLongRecordings) {
  const ImuTimeline timeline =
      readings(410.0, [](double t) { return t < 205.0 ? 0.0 : std::sin(t); });
  EXPECT_LE(timeline.bins().size(), 1000U);
  double samples = 0.0;
  for (const ImuBin& bin : timeline.bins()) {
    samples += bin.samples;
  }
  EXPECT_EQ(samples, 82000.0);
  const auto found = rest_stretches(timeline);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].end, 205.0, 2.0 * timeline.bin_width());
}

TEST(ImuTimeline, WithoutAGyroscopeNothingIsSaidOfRest) {
  ImuTimeline timeline;
  for (int i = 0; i < 600; ++i) {
    ImuSample sample;
    sample.angular_velocity.setConstant(std::numeric_limits<double>::quiet_NaN());
    sample.linear_acceleration = kUp;
    timeline.add(std::chrono::milliseconds(5LL * i), one_reading(sample));
  }
  EXPECT_TRUE(rest_stretches(timeline).empty());
  EXPECT_TRUE(timeline.bins()[3].rotation().hasNaN());
  EXPECT_LT((timeline.bins()[3].acceleration() - kUp).norm(), 1e-9);
}

}  // namespace
}  // namespace adit
