// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/live_sweep.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "adit/tools/viewer/brightness.hpp"

namespace adit {
namespace {

constexpr std::size_t kSweepPoints = 6000;
constexpr std::size_t kKeyframePoints = 3000;
constexpr float kNearest = 1e-3F;  // m; nothing is seen nearer, and sensors write 0 for no return
constexpr float kReach = 1e4F;     // m; beyond it a place would make all others one point
constexpr double kPlaces = 65536.0;
constexpr std::size_t kBrightnessSweeps = 10;  // sweeps, for how bright points are

bool is_return(const Point& point) {
  const float distance = std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z)});
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z) &&
         distance > kNearest && distance < kReach;
}

}  // namespace

SensorCloud sensor_cloud(std::span<const Point> points, std::size_t most, float brightest) {
  const std::size_t taken = std::min(points.size(), most);
  std::vector<Point> chosen;
  chosen.reserve(taken);
  float reach = 0.0F;
  for (std::size_t i = 0; i < taken; ++i) {
    const Point& point = points[i * points.size() / taken];
    if (is_return(point)) {
      chosen.push_back(point);
      reach = std::max({reach, std::abs(point.x), std::abs(point.y), std::abs(point.z)});
    }
  }
  SensorCloud cloud{.edge = 2.001 * static_cast<double>(reach)};
  cloud.points.reserve(chosen.size());
  for (const Point& point : chosen) {
    TilePoint& one = cloud.points.emplace_back();
    const std::array<float, 3> p = {point.x, point.y, point.z};
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = static_cast<double>(p[k]) / cloud.edge + 0.5;
      one.place[k] = static_cast<uint16_t>(std::clamp(share * kPlaces, 0.0, kPlaces - 1.0));
    }
    one.facts.intensity = brightness_of(point.intensity, brightest);
  }
  return cloud;
}

std::vector<Point> points_of(const SensorCloud& cloud, const Eigen::Isometry3d& T_frame_sensor) {
  std::vector<Point> points;
  points.reserve(cloud.points.size());
  for (const TilePoint& one : cloud.points) {
    const Eigen::Array3d place(one.place[0], one.place[1], one.place[2]);
    const Eigen::Vector3d p_sensor = ((place + 0.5) / kPlaces - 0.5) * cloud.edge;
    const Eigen::Vector3f p = (T_frame_sensor * p_sensor).cast<float>();
    points.push_back({.x = p.x(), .y = p.y(), .z = p.z()});
  }
  return points;
}

LiveSweep LiveSweepMaker::make(const SweepPlaced& placed, const LiveProgress& progress) {
  const SweepResult& result = placed.result;
  if (made_++ < kBrightnessSweeps && brightest_ == 0.0F) {
    brightest_ = usual_brightest(placed.sweep.points);
  }
  LiveSweep sweep{.stamp = result.stamp,
                  .T_map_lidar = result.T_map_lidar,
                  .points = sensor_cloud(placed.sweep.points, kSweepPoints, brightest_),
                  .has_intensity = brightest_ > 0.0F,
                  .progress = progress,
                  .record = sweep_record(placed.sweep.number.value_or(progress.sweeps), result)};
  if (placed.mapped) {
    if (keyframe_ != placed.mapped->keyframe) {
      keyframe_ = placed.mapped->keyframe;
      T_odom_first_ = result.T_map_lidar;
    }
    sweep.keyframe = keyframe_;
    sweep.T_map_lidar = placed.mapped->T_map_lidar;
    sweep.T_first_lidar = T_odom_first_.inverse() * result.T_map_lidar;
  }
  if (!result.cloud.empty()) {
    sweep.keyframe_cloud = sensor_cloud(result.cloud, kKeyframePoints, brightest_);
  }
  return sweep;
}

}  // namespace adit
