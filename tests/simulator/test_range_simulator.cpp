// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/range_simulator.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>

#include <gtest/gtest.h>

#include "adit/tests/simulator/trajectories.hpp"
#include "adit/tools/simulator/motion.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr RangeEffects kNone{
    .noise = false, .dropout = false, .mixed_pixels = false, .dust = false};

struct Errors {
  double rms = 0.0;  ///< m
  std::size_t count = 0;
};

/// How far the points of a sweep lie from the scene along their rays, when each is placed by the
/// true pose at its own time, or at the sweep's start.
Errors errors_of(const RangeSweep& sweep, const RayScene& scene, const SplineTrajectory& motion,
                 bool deskewed) {
  Errors errors;
  for (std::size_t i = 0; i < sweep.firings.size(); ++i) {
    if (sweep.returns[i].range == 0.0) {
      continue;
    }
    const int64_t time = sweep.start + (deskewed ? sweep.firings[i].time : 0);
    const Eigen::Isometry3d pose = motion.pose(1e-9 * static_cast<double>(time));
    const auto hit = scene.cast(pose * sweep.firings[i].origin,
                                pose.linear() * sweep.firings[i].direction, 200.0);
    if (hit) {
      const double error = sweep.returns[i].range - hit->distance;
      errors.rms += error * error;
      ++errors.count;
    }
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(errors.count));
  return errors;
}

TEST(RangeSimulator, SweepsDeskewedWithTruthLieOnTheSceneButForTheRangeNoise) {
  const Scene scene = make_room(1);
  const SplineTrajectory motion = make_trajectory(scene, motion_named("handheld"), 5.0);
  for (const char* name : {"VLP-16", "OS0-128", "Mid-360"}) {
    const RangeSensor sensor = range_sensor_named(name);
    RangeEffects noise = kNone;
    noise.noise = true;
    const RangeSimulator exact(scene, sensor, {.trajectory = &motion}, 1, kNone);
    const RangeSimulator noisy(scene, sensor, {.trajectory = &motion}, 1, noise);
    const RangeSweep true_sweep = exact.sweep(40);
    const RangeSweep sweep = noisy.sweep(40);
    EXPECT_LT(errors_of(true_sweep, exact.still(), motion, true).rms, 1e-12) << name;
    EXPECT_NEAR(errors_of(sweep, exact.still(), motion, true).rms, sensor.noise,
                0.03 * sensor.noise)
        << name;
    EXPECT_GT(errors_of(sweep, exact.still(), motion, false).rms, 4.0 * sensor.noise)
        << name << ": a sweep taken in motion does not fit without its times";
    // The points themselves, to the precision of float32.
    for (std::size_t i = 0; i < true_sweep.firings.size(); i += 97) {
      const Firing& firing = true_sweep.firings[i];
      if (true_sweep.returns[i].range > 0.0) {
        const double time = 1e-9 * static_cast<double>(true_sweep.start + firing.time);
        const Vector3d point = firing.origin + true_sweep.returns[i].range * firing.direction;
        EXPECT_LT(exact.still().distance_to(motion.pose(time) * point), 1e-6);
      }
    }
  }
}

TEST(RangeSimulator, ASweepDoesNotDependOnThoseAskedForBefore) {
  const Scene scene = make_room(1);
  const SplineTrajectory motion = make_trajectory(scene, motion_named("walk"), 3.0);
  const RangeSimulator lidar(scene, range_sensor_named("VLP-16"), {.trajectory = &motion}, 5);
  const RangeSweep once = lidar.sweep(7);
  lidar.sweep(3);
  const RangeSweep again = lidar.sweep(7);
  const RangeSimulator other(scene, range_sensor_named("VLP-16"), {.trajectory = &motion}, 6);
  const RangeSweep different = other.sweep(7);
  std::size_t same = 0;
  std::size_t same_as_other = 0;
  for (std::size_t i = 0; i < once.returns.size(); ++i) {
    same += once.returns[i].range == again.returns[i].range ? 1U : 0U;
    same_as_other += once.returns[i].range == different.returns[i].range ? 1U : 0U;
  }
  EXPECT_EQ(same, once.returns.size());
  EXPECT_LT(same_as_other, once.returns.size() / 5);
}

/// A wall of a material at x = `distance`, and nothing else.
Scene wall(double distance, Material material) {
  Scene scene;
  const double half = 3.0 * distance;
  add_quad(scene.mesh,
           {Vector3d(distance, -half, -half),
            {distance, half, -half},
            {distance, half, half},
            {distance, -half, half}},
           material);
  return scene;
}

double returned_ahead(const Scene& scene, const RangeEffects& effects) {
  const SplineTrajectory rest = test::at_rest();
  const RangeSimulator lidar(scene, range_sensor_named("VLP-16"), {.trajectory = &rest}, 1,
                             effects);
  const RangeSweep sweep = lidar.sweep(0);
  double returns = 0.0;
  double pulses = 0.0;
  for (std::size_t i = 0; i < sweep.firings.size(); ++i) {
    if (sweep.firings[i].direction.x() > 0.9) {
      pulses += 1.0;
      returns += sweep.returns[i].range > 0.0 ? 1.0 : 0.0;
    }
  }
  return returns / pulses;
}

TEST(RangeSimulator, DarkAndFarSurfacesDropOut) {
  RangeEffects dropout = kNone;
  dropout.dropout = true;
  EXPECT_EQ(returned_ahead(wall(60.0, Material::dark), kNone), 1.0);
  EXPECT_GT(returned_ahead(wall(10.0, Material::plaster), dropout), 0.99);
  EXPECT_GT(returned_ahead(wall(60.0, Material::plaster), dropout), 0.99);
  EXPECT_LT(returned_ahead(wall(60.0, Material::dark), dropout), 0.2);
}

TEST(RangeSimulator, MostPulsesGoThroughGlass) {
  Scene scene = wall(5.0, Material::glass);
  const Mesh behind = wall(9.0, Material::plaster).mesh;
  const auto base = static_cast<uint32_t>(scene.mesh.vertices.size());
  for (const Eigen::Vector3f& vertex : behind.vertices) {
    scene.mesh.vertices.push_back(vertex);
  }
  for (Triangle triangle : behind.triangles) {
    for (uint32_t& corner : triangle.corners) {
      corner += base;
    }
    scene.mesh.triangles.push_back(triangle);
  }
  const SplineTrajectory rest = test::at_rest();
  const RangeSimulator lidar(scene, range_sensor_named("VLP-16"), {.trajectory = &rest}, 1, kNone);
  const RangeSweep sweep = lidar.sweep(0);
  double through = 0.0;
  double stopped = 0.0;
  for (std::size_t i = 0; i < sweep.firings.size(); ++i) {
    const double x = sweep.returns[i].range * sweep.firings[i].direction.x();
    through += std::abs(x - 9.0) < 1e-4 ? 1.0 : 0.0;
    stopped += std::abs(x - 5.0) < 1e-4 ? 1.0 : 0.0;
  }
  EXPECT_NEAR(stopped / (through + stopped), 0.1, 0.01);
}

/// The returns of a sweep at rest whose x (m) is within a millimetre of `x`, of such a surface.
int64_t returns_at(const RangeSweep& sweep, double x, uint8_t surface) {
  return static_cast<int64_t>(std::ranges::count_if(
      std::views::iota(std::size_t{0}, sweep.firings.size()), [&](std::size_t i) {
        const Firing& firing = sweep.firings[i];
        const double at = firing.origin.x() + sweep.returns[i].range * firing.direction.x();
        return std::abs(at - x) < 1e-3 && (sweep.returns[i].surface & 127U) == surface;
      }));
}

TEST(RangeSimulator, APaneOfGlassShowsWhatIsBeforeItBehindIt) {
  constexpr uint8_t kGlass = static_cast<uint8_t>(Material::glass) + 1;
  Scene scene = wall(5.0, Material::glass);
  add_block(scene.mesh, {-3.2, -9.0, -9.0}, {-3.0, 9.0, 9.0}, Material::plaster);
  const SplineTrajectory rest = test::at_rest();
  const auto sweep_of = [&](bool reflections) {
    RangeEffects effects = kNone;
    effects.reflections = reflections;
    return RangeSimulator(scene, range_sensor_named("VLP-16"), {.trajectory = &rest}, 1, effects)
        .sweep(0);
  };
  const RangeSweep plain = sweep_of(false);
  const RangeSweep mirrors = sweep_of(true);
  EXPECT_EQ(returns_at(plain, 13.0, kMirrored), 0);
  // The wall at -3 m is 8 m before the pane: it is measured 8 m behind it.
  EXPECT_GT(returns_at(mirrors, 13.0, kMirrored), 1000);
  const auto mirrored = [](const Return& one) { return one.surface == kMirrored; };
  EXPECT_EQ(std::ranges::count_if(mirrors.returns, mirrored), returns_at(mirrors, 13.0, kMirrored));
  // The pane itself answers a pulse in ten, and where it is square to the beam.
  EXPECT_GE(returns_at(mirrors, 5.0, kGlass), returns_at(plain, 5.0, kGlass));
  EXPECT_LT(returns_at(mirrors, 5.0, kGlass), returns_at(mirrors, 13.0, kMirrored));
}

TEST(RangeSimulator, WhatIsBehindGlassOutshinesWhatIsMirroredUnlessSeenAtASlant) {
  Scene scene = wall(5.0, Material::glass);
  add_block(scene.mesh, {-3.2, -90.0, -9.0}, {-3.0, 90.0, 9.0}, Material::plaster);
  add_block(scene.mesh, {9.0, -90.0, -9.0}, {9.2, 90.0, 9.0}, Material::plaster);
  const SplineTrajectory rest = test::at_rest();
  RangeEffects effects = kNone;
  effects.reflections = true;
  const RangeSweep sweep =
      RangeSimulator(scene, range_sensor_named("VLP-16"), {.trajectory = &rest}, 1, effects)
          .sweep(0);
  for (std::size_t i = 0; i < sweep.firings.size(); ++i) {
    if (sweep.returns[i].surface == kMirrored) {
      // Both walls send their light back through or off the pane at the same angle: R^2 / 13^2
      // exceeds (1 - R)^2 / 9^2 where R > 0.59, from 82 degrees on by Schlick's approximation.
      EXPECT_LT(sweep.firings[i].direction.x(), 0.14);
    }
  }
}

TEST(RangeSimulator, BeamsOnAnEdgeMeasureBetweenTheSurfaces) {
  Scene scene = wall(6.0, Material::plaster);
  add_block(scene.mesh, {5.5, -0.3, -5.0}, {5.6, 0.3, 5.0}, Material::wood);
  const SplineTrajectory rest = test::at_rest();
  const auto between = [&](bool mixed) {
    RangeEffects effects = kNone;
    effects.mixed_pixels = mixed;
    const RangeSimulator lidar(scene, range_sensor_named("OS0-128"), {.trajectory = &rest}, 1,
                               effects);
    const RangeSweep sweep = lidar.sweep(0);
    return std::ranges::count_if(
        std::views::iota(std::size_t{0}, sweep.firings.size()), [&](std::size_t i) {
          const Firing& firing = sweep.firings[i];
          const double x = firing.origin.x() + sweep.returns[i].range * firing.direction.x();
          return x > 5.61 && x < 5.99;
        });
  };
  EXPECT_EQ(between(false), 0);
  EXPECT_GT(between(true), 50);
  EXPECT_LT(between(true), 1000) << "of the 131072 pulses few meet an edge";
}

TEST(RangeSimulator, MovingObjectsAreHitWhereTheyAreAtThatMomentAndLabelled) {
  Scene scene = wall(20.0, Material::plaster);
  MovingObject box{.label = "box", .mesh = {}, .T_world_object = [](double time) {
                     Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
                     pose.translation() = Vector3d(8.0 + 10.0 * time, 0.0, 0.0);
                     return pose;
                   }};
  add_block(box.mesh, {-0.5, -30.0, -30.0}, {0.5, 30.0, 30.0}, Material::metal);
  scene.moving.push_back(box);
  const SplineTrajectory rest = test::at_rest();
  const RangeSimulator lidar(scene, range_sensor_named("VLP-16"), {.trajectory = &rest}, 1, kNone);
  const RangeSweep sweep = lidar.sweep(5);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < sweep.firings.size(); ++i) {
    const Firing& firing = sweep.firings[i];
    if (firing.direction.x() > 0.9) {
      const double time = 1e-9 * static_cast<double>(sweep.start + firing.time);
      EXPECT_EQ(sweep.returns[i].object, 1);
      EXPECT_NEAR(sweep.returns[i].range * firing.direction.x(), 7.5 + 10.0 * time, 1e-6);
      ++seen;
    }
  }
  EXPECT_GT(seen, 1000U);
}

TEST(OutOfTheWay, WhatWouldRunIntoTheCarrierIsLeftOut) {
  Scene scene;
  for (const double lane : {0.0, 3.0}) {
    MovingObject car{.label = "car", .mesh = {}, .T_world_object = [lane](double time) {
                       Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
                       pose.translation() = Vector3d(20.0 - 10.0 * time, lane, 0.0);
                       return pose;
                     }};
    add_block(car.mesh, {-2.0, -0.9, 0.0}, {2.0, 0.9, 1.5}, Material::metal);
    scene.moving.push_back(car);
  }
  const auto still = [](double) { return Eigen::Isometry3d::Identity(); };
  EXPECT_EQ(out_of_the_way(scene, still, 1.0, 1.0).moving.size(), 2U) << "nothing arrives in 1 s";
  const Scene kept = out_of_the_way(scene, still, 4.0, 1.0);
  ASSERT_EQ(kept.moving.size(), 1U);
  EXPECT_EQ(kept.moving.front().T_world_object(0.0).translation().y(), 3.0);
  EXPECT_TRUE(out_of_the_way(scene, still, 4.0, 2.2).moving.empty()) << "2.1 m between them";
}

TEST(RangeSimulator, DustScattersWithItsDensity) {
  Scene scene = wall(1e3, Material::dark);
  scene.dust = 0.02;
  const SplineTrajectory rest = test::at_rest();
  RangeEffects dust = kNone;
  dust.dust = true;
  const RangeSensor sensor = range_sensor_named("VLP-16");
  const RangeSimulator lidar(scene, sensor, {.trajectory = &rest}, 1, dust);
  const RangeSweep sweep = lidar.sweep(0);
  double scattered = 0.0;
  for (const Return& back : sweep.returns) {
    scattered += back.range > 0.0 ? 1.0 : 0.0;
  }
  const double nearest = std::exp(-0.02 * sensor.nearest);
  const double farthest = std::exp(-0.02 * 0.2 * sensor.range_at_tenth);
  EXPECT_NEAR(scattered / static_cast<double>(sweep.returns.size()), nearest - farthest, 0.01);
}

}  // namespace
}  // namespace adit
