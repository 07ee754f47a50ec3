// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The simulated 4D radar.
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "adit/slam/core/units.hpp"
#include "adit/slam/registration/radar_aligner.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/range_simulator.hpp"
#include "adit/tools/simulator/simulation.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

TEST(SimulatedRadar, ErrsInBearingAndHasGhosts) {
  const Scene scene = make_scene("room", 1);
  const SplineTrajectory trajectory = make_trajectory(scene, motion_named("drive"), 4.0);
  const RangeMount mount{.trajectory = &trajectory};
  const RangeSensor sensor = range_sensor_named("radar-4d");
  const RangeEffects noisy{.noise = true, .dropout = false, .mixed_pixels = false, .dust = false};
  const RangeEffects none{.noise = false, .dropout = false, .mixed_pixels = false, .dust = false};
  const RangeSimulator with(scene, sensor, mount, 1, noisy);
  const RangeSimulator without(scene, sensor, mount, 1, none);
  std::size_t count = 0;
  std::size_t ghosts = 0;
  double squared = 0.0;
  for (int64_t scan = 0; scan < 20; ++scan) {
    const RangeSweep noise = with.sweep(scan);
    const RangeSweep clean = without.sweep(scan);
    ASSERT_EQ(noise.firings.size(), 600U);
    for (std::size_t i = 0; i < noise.firings.size(); ++i) {
      const Vector3d& d = clean.firings[i].direction;
      EXPECT_LE(std::abs(std::atan2(d.y(), d.x())), 60.1 / kDegreesPerRadian);
      EXPECT_LE(std::abs(std::asin(d.z())), 20.1 / kDegreesPerRadian);
      if (clean.returns[i].range > 0.0 && noise.returns[i].range > 0.0) {
        const double turned = noise.firings[i].direction.cross(d).norm();
        squared += turned * turned;
        ghosts += noise.returns[i].range > 1.15 * clean.returns[i].range + 0.5 ? 1U : 0U;
        ++count;
      }
    }
  }
  ASSERT_GT(count, 5000U);
  const double sigma = std::sqrt(squared / static_cast<double>(count)) * kDegreesPerRadian;
  EXPECT_NEAR(sigma, std::hypot(1.0, 1.5), 0.1) << "degrees";
  const double share = static_cast<double>(ghosts) / static_cast<double>(count);
  EXPECT_GE(share, 0.02);
  EXPECT_LE(share, 0.055);
}

TEST(SimulatedRadar, IsARadarToWhoReadsIt) {
  const test::TemporaryFolder folder;
  SimulationOptions options;
  options.scene = "room";
  options.trajectory = "drive";
  options.duration = 0.5;
  options.picture = false;
  options.output = folder.path() / "x.mcap";
  options.lidars.front().sensor = "radar-4d";
  simulate(options, {});
  const auto recording = open_recording(options.output);
  const auto events = recording->events({});
  std::size_t scans = 0;
  while (const auto event = events->next()) {
    if (const auto* sweep = std::get_if<Sweep>(&event->value)) {
      EXPECT_TRUE(is_radar_scan(*sweep));
      EXPECT_TRUE(sweep->rings.empty());
      EXPECT_TRUE(sweep->times.empty());
      EXPECT_GT(sweep->points.size(), 100U);
      ++scans;
    }
  }
  EXPECT_EQ(scans, 10U) << "20 a second";
}

}  // namespace
}  // namespace adit
