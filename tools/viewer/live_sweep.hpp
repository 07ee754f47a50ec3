// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a page gets of a sweep that was placed while a run goes on: its pose and some of its points.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adit/slam/executor/slam.hpp"
#include "adit/tools/results/run_sources.hpp"
#include "adit/tools/results/sweep_table.hpp"
#include "adit/tools/viewer/cloud_tiles.hpp"

namespace adit {

/// Points about a sensor: places count 2^-16 of the edge of a cube that the sensor is the middle
/// of, sensor axes.
struct SensorCloud {
  double edge = 0.0;                ///< m
  std::vector<TilePoint> points{};  ///< empty: there are none
};

/// Evenly thinned to `most` points. NaN and (0, 0, 0), which mean no return, are left out.
/// `brightest` is the intensity that 255 stands for; 0: points have none.
SensorCloud sensor_cloud(std::span<const Point> points, std::size_t most, float brightest = 0.0F);
/// The points again, m, where `T_frame_sensor` has them.
std::vector<Point> points_of(const SensorCloud& cloud, const Eigen::Isometry3d& T_frame_sensor);

/// A stretch that a run does not vouch for.
struct LiveStretch {
  std::string state{};  ///< "doubtful" or "lost"
  Nanoseconds begin{0};
  Nanoseconds end{0};
  std::string text{};  ///< why, for people

  bool operator==(const LiveStretch&) const = default;
};

/// How far a run has come.
struct LiveProgress {
  std::size_t sweeps = 0;                ///< done
  std::size_t of = 0;                    ///< that are to be mapped
  std::size_t failed = 0;                ///< could not be aligned
  std::string verdict{};                 ///< on the sweeps so far
  std::vector<LiveStretch> stretches{};  ///< likewise; the last ones, where there are many
  std::vector<SourceWorth> sources{};    ///< of the motion so far
};

/// A sweep on its way to the page.
struct LiveSweep {
  Nanoseconds stamp{0};
  std::optional<NodeId> keyframe{};  ///< whose submap it belongs to; none: there is no map
  /// The pose as it was known when the sweep was placed: of the map, where there is one.
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  /// In the axes of the keyframe's first sweep, by the odometry.
  Eigen::Isometry3d T_first_lidar = Eigen::Isometry3d::Identity();
  SensorCloud points{};                         ///< of the sweep as it came
  std::optional<SensorCloud> keyframe_cloud{};  ///< de-skewed and down-sampled: it stays
  bool has_intensity = false;                   ///< of these points
  LiveProgress progress{};
  SweepRecord record{};  ///< as sweeps.csv has it
};

/// Makes them of a run's sweeps, in their order.
class LiveSweepMaker {
 public:
  LiveSweep make(const SweepPlaced& placed, const LiveProgress& progress);

 private:
  std::optional<NodeId> keyframe_;
  std::size_t made_ = 0;
  float brightest_ = 0.0F;  ///< of the first sweeps; 0: they have no intensity
  Eigen::Isometry3d T_odom_first_ = Eigen::Isometry3d::Identity();  ///< of the keyframe
};

}  // namespace adit
