// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/live_map.hpp"

#include <algorithm>
#include <utility>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"

namespace adit {
namespace {

constexpr double kVoxel = 0.2;                  // m, of the cloud at first
constexpr std::size_t kMostPoints = 1'000'000;  // of the cloud: a message of 16 MB
constexpr double kReach = 20.0;                 // m: by so far a turn moves what is seen

}  // namespace

LiveMap::LiveMap() : voxel_(kVoxel), thinning_(kVoxel), grid_(OccupancyGridConfig{}) {}

LiveMapChange LiveMap::read(const std::filesystem::path& map, const std::function<bool()>& stop) {
  const MapDatabase database(map, MapAccess::read);
  const std::vector<MapKeyframe> stored = database.keyframes();
  LiveMapChange change;
  if (std::ranges::any_of(stored, [&](const auto& keyframe) { return has_moved(keyframe); })) {
    begin_anew(voxel_);
  }
  if (points_.size() > kMostPoints) {
    begin_anew(2.0 * voxel_);
  }
  std::vector<LiveKeyframe> keyframes;
  for (const MapKeyframe& keyframe : stored) {
    if (!added_.contains(keyframe.id)) {
      if (stop()) {
        break;
      }
      add(keyframe, load_submap(database, keyframe.id, map));
      change.points = true;
    }
    keyframes.push_back({.stamp = keyframe.stamp,
                         .T_map_lidar = keyframe.T_map_keyframe * T_keyframe_first_[keyframe.id]});
  }
  change.keyframes =
      !std::ranges::equal(keyframes, keyframes_, [](const auto& now, const auto& before) {
        return now.stamp == before.stamp && now.T_map_lidar.matrix() == before.T_map_lidar.matrix();
      });
  keyframes_ = std::move(keyframes);
  return change;
}

bool LiveMap::has_moved(const MapKeyframe& keyframe) const {
  const auto added = added_.find(keyframe.id);
  if (added == added_.end()) {
    return false;
  }
  const Eigen::Isometry3d moved = added->second.inverse() * keyframe.T_map_keyframe;
  const double turn = Eigen::AngleAxisd(moved.rotation()).angle();
  return moved.translation().norm() + kReach * turn > grid_.cell();
}

void LiveMap::begin_anew(double voxel) {
  voxel_ = voxel;
  added_.clear();
  points_.clear();
  thinning_ = MapThinning(voxel);
  grid_ = OccupancyGrid(OccupancyGridConfig{});
}

void LiveMap::add(const MapKeyframe& keyframe, const KeyframeSubmap& submap) {
  added_[keyframe.id] = keyframe.T_map_keyframe;
  T_keyframe_first_[keyframe.id] = submap.sweeps.empty() ? Eigen::Isometry3d::Identity()
                                                         : submap.sweeps.front().T_keyframe_lidar;
  grid_.add(keyframe, submap, ProductCoordinates(), CloudSelection());
  for (const SubmapPoint& point : submap.points) {
    const Eigen::Vector3d p = keyframe.T_map_keyframe * point.position();
    if (!point.seen_through && thinning_.take(p)) {
      const Eigen::Vector3f single = p.cast<float>();
      points_.push_back({.x = single.x(), .y = single.y(), .z = single.z(), .intensity = 0.0F});
    }
  }
}

}  // namespace adit
