// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A made-up street and what a small spinning lidar sees of it. Everything has a closed form, so the
// poses are known exactly, and everything is seeded, so that every run sees the same points.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/tools/support/random.hpp"

namespace adit::test {

/// A solid with sides along the axes of the world, m.
struct Block {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};

/// A vertical cylinder that stands on the ground, m.
struct Pole {
  Eigen::Vector2d centre;
  double radius = 0.0;
  double height = 0.0;
};

/// Frame: world, z up, the ground is z = 0.
struct World {
  std::vector<Block> blocks;
  std::vector<Pole> poles;
};

/// Houses of several depths and heights on both sides of the x axis, parked cars and lamp posts,
/// from x = -60 m to `length` + 60 m. No two stretches of it look alike.
inline World make_street(double length, uint64_t seed = 1) {
  World world;
  Random random(seed);
  for (const double side : {-1.0, 1.0}) {
    const auto block = [&](double x, double size_x, double y, double size_y, double height) {
      world.blocks.push_back({{x, std::min(side * y, side * (y + size_y)), 0.0},
                              {x + size_x, std::max(side * y, side * (y + size_y)), height}});
    };
    for (double x = -60.0; x < length + 60.0;) {
      const double width = random.uniform(5.0, 14.0);
      block(x, width, random.uniform(7.0, 11.0), 8.0, random.uniform(4.0, 12.0));
      x += width + (random.uniform(0.0, 1.0) < 0.3 ? random.uniform(3.0, 8.0) : 0.0);
    }
    for (double x = -60.0; x < length + 60.0; x += random.uniform(6.0, 16.0)) {
      block(x, random.uniform(3.8, 4.8), random.uniform(3.6, 4.2), 1.8, random.uniform(1.3, 2.0));
    }
    for (double x = -60.0; x < length + 60.0; x += random.uniform(9.0, 20.0)) {
      world.poles.push_back({{x, side * 6.3}, 0.12, 6.0});
    }
  }
  return world;
}

/// Beams evenly spaced in elevation, columns in azimuth; all of a sweep is taken at once.
struct Lidar {
  int beams = 32;
  int columns = 480;
  double lowest = -0.40;      ///< rad
  double highest = 0.10;      ///< rad
  double max_range = 70.0;    ///< m
  double range_noise = 0.01;  ///< m, standard deviation
  /// rad, the wider of the two directions
  double beam_spacing() const {
    return std::max((highest - lowest) / (beams - 1), 2.0 * std::numbers::pi / columns);
  }
};

/// Distance (m) along the ray of unit direction to the first surface; infinite where there is none.
inline double cast(const World& world, const Eigen::Vector3d& origin,
                   const Eigen::Vector3d& direction) {
  double nearest =
      direction.z() < 0.0 ? -origin.z() / direction.z() : std::numeric_limits<double>::infinity();
  const Eigen::Vector3d inverse = direction.cwiseInverse();
  for (const Block& block : world.blocks) {
    const Eigen::Array3d a = (block.low - origin).array() * inverse.array();
    const Eigen::Array3d b = (block.high - origin).array() * inverse.array();
    const double enter = a.min(b).maxCoeff();
    if (enter > 0.0 && enter < nearest && enter <= a.max(b).minCoeff()) {
      nearest = enter;
    }
  }
  const double flat = direction.head<2>().squaredNorm();
  for (const Pole& pole : world.poles) {
    const Eigen::Vector2d to_centre = pole.centre - origin.head<2>();
    const double along = to_centre.dot(direction.head<2>());
    const double root =
        along * along - flat * (to_centre.squaredNorm() - pole.radius * pole.radius);
    if (along <= 0.0 || root < 0.0) {
      continue;
    }
    const double distance = (along - std::sqrt(root)) / flat;
    const double height = origin.z() + distance * direction.z();
    if (distance > 0.0 && distance < nearest && height <= pole.height) {
      nearest = distance;
    }
  }
  return nearest;
}

/// What the lidar measures at a pose. `seed` and the stamp choose the noise.
inline Sweep scan(const World& world, const StampedPose& T_world_lidar, const Lidar& lidar,
                  uint64_t seed = 1) {
  Random random(seed * 1'000'003U + static_cast<uint64_t>(T_world_lidar.stamp.count()));
  Sweep sweep;
  sweep.stamp = T_world_lidar.stamp;
  sweep.source = "synthetic sweep";
  const Eigen::Matrix3d rotation = T_world_lidar.pose.linear();
  const Eigen::Vector3d origin = T_world_lidar.pose.translation();
  for (int beam = 0; beam < lidar.beams; ++beam) {
    const double elevation =
        lidar.lowest + (lidar.highest - lidar.lowest) * beam / (lidar.beams - 1);
    for (int column = 0; column < lidar.columns; ++column) {
      const double azimuth = 2.0 * std::numbers::pi * column / lidar.columns;
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const double distance = cast(world, origin, rotation * direction);
      const double measured = distance + lidar.range_noise * random.gaussian();
      if (distance < lidar.max_range) {
        const Eigen::Vector3f p = (measured * direction).cast<float>();
        sweep.points.push_back({p.x(), p.y(), p.z(), 0.5F});
      } else {
        sweep.points.push_back({});  // no return
      }
    }
  }
  return sweep;
}

/// `count` poses, one every 100 ms, each moved by the same body twist [rho, phi] (m, rad) from the
/// one before. The first is at the height of a car's roof over the world's origin.
inline std::vector<StampedPose> steady_drive(size_t count, const Vector6d& twist) {
  std::vector<StampedPose> poses;
  StampedPose pose;
  pose.stamp = Nanoseconds(1'700'000'000'000'000'000);
  pose.pose.translation() << 0.0, 0.0, 1.8;
  for (size_t i = 0; i < count; ++i) {
    poses.push_back(pose);
    pose.stamp += std::chrono::milliseconds(100);
    pose.pose = orthonormalized(pose.pose * se3_exp(twist));
  }
  return poses;
}

inline Vector6d twist(double forward, double yaw = 0.0) {
  Vector6d xi = Vector6d::Zero();
  xi(0) = forward;
  xi(5) = yaw;
  return xi;
}

inline std::vector<Sweep> scan_all(const World& world, const std::vector<StampedPose>& poses,
                                   const Lidar& lidar) {
  std::vector<Sweep> sweeps;
  sweeps.reserve(poses.size());
  for (const StampedPose& pose : poses) {
    sweeps.push_back(scan(world, pose, lidar));
  }
  return sweeps;
}

}  // namespace adit::test
