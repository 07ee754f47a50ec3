// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The drive of `adit demo`: a street with a left and a right turn, and a car with a spinning lidar
// that is in motion from the first sweep on. Everything is computed, nothing is recorded; the poses
// are known exactly.
#pragma once

#include <cstddef>
#include <vector>

#include "slam/types.hpp"
#include "tools/demo_scene.hpp"
#include "tools/random.hpp"

namespace adit {

/// A lidar of `beams` evenly spaced in elevation and `columns` in azimuth, which takes a whole
/// sweep at once.
struct SpinningLidar {
  int beams = 32;
  double lowest = -0.384;       ///< rad (-22 deg)
  double highest = 0.157;       ///< rad (9 deg)
  int columns = 1200;           ///< 0.3 deg
  double max_range = 80.0;      ///< m
  double range_noise = 0.02;    ///< m, standard deviation
  double beam_spacing() const;  ///< rad, the wider of the two directions
};

struct DemoDrive {
  std::vector<SceneObject> scene;
  std::vector<StampedPose> poses;  ///< T_world_lidar, 10 Hz
};

/// The drive, `sweeps` long. A shorter one is the beginning of a longer one.
DemoDrive make_demo_drive(std::size_t sweeps = 100);

/// What the lidar measures from a pose. Rays that hit nothing leave no point, as in KITTI's files.
Sweep scan(const std::vector<SceneObject>& scene, const StampedPose& T_world_lidar,
           const SpinningLidar& lidar, Random& random);

}  // namespace adit
