// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/configured_recording.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "adit/slam/core/config.hpp"

namespace adit {
namespace {

Sweep corrected_sweep(Sweep sweep, const RecordingConfig& config) {
  return std::get<Sweep>(corrected(std::move(sweep), config));
}

// A sensor that drives along x at 10 m/s and turns clockwise ten times a second, past posts: what
// it sees of each, and when, is worked out here from the times, and must come back as them.
TEST(SpinRate, TimesOfPointsFollowFromTheirAzimuth) {
  constexpr double kSpin = -10.0;
  Sweep sweep;
  sweep.stamp = nanoseconds(5.0);
  std::vector<double> expected;
  for (const double time : {0.001, 0.02, 0.049, 0.05, 0.07, 0.099}) {
    const double azimuth = 2.0 * std::numbers::pi * kSpin * (time - 0.05);
    sweep.points.push_back({static_cast<float>(20.0 * std::cos(azimuth)),
                            static_cast<float>(20.0 * std::sin(azimuth)), -1.0F, 0.0F});
    expected.push_back(time);
  }
  const Sweep turned = corrected_sweep(sweep, {.spin_rate = kSpin});
  EXPECT_EQ(turned.stamp, nanoseconds(4.95));
  ASSERT_EQ(turned.times.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(turned.times[i], expected[i], 1e-6) << i;
  }
  // The other way round the same azimuths come in the opposite order.
  const Sweep other = corrected_sweep(sweep, {.spin_rate = -kSpin});
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(other.times[i], 0.1 - expected[i], 1e-6) << i;
  }
}

TEST(SpinRate, NoReturnsGetATimeOfTheTurn) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Sweep sweep;
  sweep.points = {{nan, nan, nan, 0.0F}, {0.0F, 0.0F, 0.0F, 0.0F}};
  const Sweep turned = corrected_sweep(sweep, {.spin_rate = 20.0});
  EXPECT_FLOAT_EQ(turned.times[0], 0.025F);
  EXPECT_FLOAT_EQ(turned.times[1], 0.025F);
}

TEST(SpinRate, TimesThatTheRecordingHasAreKept) {
  Sweep sweep;
  sweep.stamp = nanoseconds(5.0);
  sweep.points = {{1.0F, 2.0F, 0.0F, 0.0F}};
  sweep.times = {0.03F};
  const Sweep kept = corrected_sweep(sweep, {.spin_rate = -10.0});
  EXPECT_EQ(kept.stamp, sweep.stamp);
  EXPECT_EQ(kept.times, sweep.times);
}

TEST(BeamElevation, PointsTurnUpwardsAtTheirRangeAndAzimuth) {
  constexpr double kAngle = 0.01;
  Sweep sweep;
  sweep.points = {{3.0F, -4.0F, -2.0F, 7.0F}, {0.0F, 0.0F, 5.0F, 0.0F}};
  const Sweep raised = corrected_sweep(sweep, {.beam_elevation = kAngle});
  const Point& p = raised.points[0];
  EXPECT_NEAR(std::atan2(p.z, std::hypot(p.x, p.y)), std::atan2(-2.0, 5.0) + kAngle, 1e-6);
  EXPECT_NEAR(std::hypot(p.x, p.y, p.z), std::sqrt(29.0), 1e-5);
  EXPECT_NEAR(p.y / p.x, -4.0 / 3.0, 1e-6);
  EXPECT_EQ(p.intensity, 7.0F);
  EXPECT_EQ(raised.points[1].z, 5.0F);  // straight above no way is upwards
}

TEST(RecordingSettings, TurnsAndElevationsThatNoScannerHasAreRefused) {
  Config config;
  config.recording.spin_rate = 0.1;
  EXPECT_EQ(validate(config)->field, "recording.spin_rate");
  config.recording.spin_rate = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(validate(config)->field, "recording.spin_rate");
  config.recording.spin_rate = -10.0;
  config.recording.beam_elevation = 0.205;
  EXPECT_EQ(validate(config)->field, "recording.beam_elevation");
}

}  // namespace
}  // namespace adit
