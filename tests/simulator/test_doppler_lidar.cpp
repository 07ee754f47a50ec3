// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Radial speeds of simulated returns.
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/range_simulator.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr RangeEffects kPerfect{
    .noise = false, .dropout = false, .mixed_pixels = false, .dust = false};

RangeSensor sensor() {
  RangeSensor sensor = range_sensor_named("VLP-16");
  sensor.doppler = true;
  return sensor;
}

TEST(DopplerLidar, MeasuresTheSensorsMotionOfWhatStandsStill) {
  const Scene scene = make_scene("mine", 1);
  const SplineTrajectory trajectory = make_trajectory(scene, motion_named("fast-handheld"), 10.0);
  const RangeMount mount{.trajectory = &trajectory, .T_body_lidar = lidar_mount()};
  const RangeSimulator lidar(scene, sensor(), mount, 1, kPerfect);
  const RangeSweep sweep = lidar.sweep(60);
  EXPECT_TRUE(sweep.doppler);
  double greatest = 0.0;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < sweep.returns.size(); i += 17) {
    const Return& back = sweep.returns[i];
    if (back.range == 0.0) {
      continue;
    }
    const Firing& firing = sweep.firings[i];
    const double time = 1e-9 * static_cast<double>(sweep.start + firing.time);
    constexpr double kStep = 1e-4;
    const Vector3d p_world = lidar.pose(time) * (firing.origin + back.range * firing.direction);
    const auto range_at = [&](double t) {
      return (p_world - lidar.pose(t) * firing.origin).norm();
    };
    const double expected = (range_at(time + kStep) - range_at(time - kStep)) / (2.0 * kStep);
    EXPECT_NEAR(static_cast<double>(back.doppler), expected, 1e-4);
    greatest = std::max(greatest, std::abs(expected));
    ++compared;
  }
  EXPECT_GT(compared, 1000U);
  EXPECT_GT(greatest, 2.0) << "it runs at 3 m/s";
}

TEST(DopplerLidar, SeesWhatMovesAndTurns) {
  Scene scene;
  MovingObject car{.label = "car", .mesh = {}, .T_world_object = [](double time) {
                     Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
                     pose.translation() = Vector3d(10.0 + 4.0 * time, 0.0, 0.0);
                     return pose;
                   }};
  add_block(car.mesh, {-1.0, -3.0, -3.0}, {1.0, 3.0, 3.0}, Material::concrete);
  scene.moving.push_back(car);
  add_block(scene.mesh, {-20.0, -30.0, -3.0}, {-19.0, 30.0, 3.0}, Material::concrete);
  const SplineTrajectory rest(0.5,
                              std::vector<Eigen::Isometry3d>(10, Eigen::Isometry3d::Identity()));
  const RangeSimulator lidar(scene, sensor(), {.trajectory = &rest}, 1, kPerfect);
  const RangeSweep sweep = lidar.sweep(2);
  std::size_t moving = 0;
  std::size_t still = 0;
  for (std::size_t i = 0; i < sweep.returns.size(); ++i) {
    const Return& back = sweep.returns[i];
    if (back.range == 0.0) {
      continue;
    }
    const double expected = back.object == 1 ? 4.0 * sweep.firings[i].direction.x() : 0.0;
    EXPECT_NEAR(static_cast<double>(back.doppler), expected, 1e-5);
    (back.object == 1 ? moving : still) += 1;
  }
  EXPECT_GT(moving, 500U);
  EXPECT_GT(still, 500U);
}

TEST(DopplerLidar, NoiseIsAsStatedAndLeavesTheRangesAlone) {
  const Scene scene = make_scene("room", 1);
  const SplineTrajectory trajectory = make_trajectory(scene, motion_named("drive"), 4.0);
  const RangeMount mount{.trajectory = &trajectory};
  const RangeEffects noisy{.noise = true, .dropout = false, .mixed_pixels = false, .dust = false};
  const RangeSweep without = RangeSimulator(scene, sensor(), mount, 1, kPerfect).sweep(20);
  const RangeSweep with = RangeSimulator(scene, sensor(), mount, 1, noisy).sweep(20);
  const RangeSweep plain =
      RangeSimulator(scene, range_sensor_named("VLP-16"), mount, 1, noisy).sweep(20);
  EXPECT_FALSE(plain.doppler);
  double squared = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < with.returns.size(); ++i) {
    EXPECT_EQ(with.returns[i].range, plain.returns[i].range);
    EXPECT_EQ(plain.returns[i].doppler, 0.0F);
    if (with.returns[i].range > 0.0 && without.returns[i].range > 0.0) {
      const auto error = static_cast<double>(with.returns[i].doppler - without.returns[i].doppler);
      squared += error * error;
      ++count;
    }
  }
  ASSERT_GT(count, 10'000U);
  EXPECT_NEAR(std::sqrt(squared / static_cast<double>(count)), 0.05, 0.002);
}

/// Of each driver's layout the recording gives the speeds back.
TEST(DopplerLidar, IsWrittenInTheCloudsOfEveryDriverThatHasFields) {
  const test::TemporaryFolder folder;
  SimulationOptions options;
  options.scene = "room";
  options.trajectory = "moving-start";
  options.duration = 0.2;
  options.picture = false;
  options.output = folder.path() / "x.mcap";
  options.lidars.front().doppler = true;
  for (const CloudLayout layout :
       {CloudLayout::velodyne, CloudLayout::ouster, CloudLayout::hesai, CloudLayout::camera}) {
    options.lidars.front().layout = layout;
    const SimulationSummary summary = simulate(options, {});
    std::size_t numbers = 0;
    std::size_t sweeps = 0;
    const auto recording = open_recording(options.output);
    const auto events = recording->events({});
    while (const auto event = events->next()) {
      if (const auto* sweep = std::get_if<Sweep>(&event->value)) {
        ASSERT_EQ(sweep->doppler.size(), sweep->points.size()) << to_string(layout);
        ++sweeps;
        for (std::size_t i = 0; i < sweep->points.size(); ++i) {
          const Point& p = sweep->points[i];
          const bool seen = std::isfinite(p.x) && (p.x != 0.0F || p.y != 0.0F || p.z != 0.0F);
          EXPECT_EQ(std::isfinite(sweep->doppler[i]), seen);
          numbers += seen ? 1U : 0U;
        }
      }
    }
    EXPECT_EQ(sweeps, 2U);
    EXPECT_EQ(numbers, summary.points) << to_string(layout);
  }
  options.lidars.front().layout = CloudLayout::livox;
  EXPECT_THROW(simulate(options, {}), UsageError);
}

}  // namespace
}  // namespace adit
