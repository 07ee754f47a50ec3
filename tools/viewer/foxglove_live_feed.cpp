// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/foxglove_live_feed.hpp"

#include <algorithm>
#include <array>

#include "adit/tools/foxglove/sweep_message.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostMapPoints = 200'000;
constexpr std::size_t kDrawnAfter = 10;  // poses, the trajectory anew
const ShownTopic kLidarPointsTopic{"/lidar/points", "foxglove.PointCloud"};

/// The channels, by their places.
enum class Live { log, transform, pose, sweep, lidar, keyframe, map, trajectory, graph };
constexpr std::size_t kFirstGraph = static_cast<std::size_t>(Live::graph);
constexpr std::array kGraphTopics = {kKeyframesTopic, kOdometryTopic, kConstraintsTopic,
                                     kLoopsTopic, kUncertaintyTopic};

Live kind_of(std::size_t channel) {
  return static_cast<Live>(std::min(channel, kFirstGraph));
}

std::optional<uint64_t> if_after(uint64_t position, uint64_t after) {
  return position > after ? std::optional(position) : std::nullopt;
}

/// The first of a list in the order of versions.
template <class List, class Version>
std::optional<uint64_t> first_after(const List& list, uint64_t after, Version version) {
  const auto found = std::ranges::upper_bound(list, after, {}, version);
  return found == list.end() ? std::nullopt : std::optional(version(*found));
}

uint64_t version_of(const LiveScene::Numbered& cloud) {
  return cloud.version;
}

uint64_t version_of_newest(const LiveScene::Newest& sweep) {
  return sweep.shown.version;
}

/// When the trajectory was another one last; not each time that it grows.
uint64_t drawn_at(const LiveScene& scene) {
  const std::size_t whole = (scene.poses().size() - 1) / kDrawnAfter * kDrawnAfter;
  return std::max(scene.versions().poses, scene.poses()[whole].version);
}

ShownMessage trajectory_of(const LiveScene& scene) {
  std::vector<StampedPose> poses;
  for (const LiveScene::Pose& pose : scene.poses()) {
    poses.push_back({.stamp = pose.stamp, .pose = pose.placed.T_map_lidar});
  }
  return drawn_message(scene.span().last, shown_trajectory(poses, {}));
}

/// All clouds together, evenly thinned.
ShownMessage map_points_of(const LiveScene& scene) {
  std::size_t count = 0;
  for (const LiveScene::Numbered& cloud : scene.clouds()) {
    count += cloud.cloud.points.size();
  }
  const std::size_t stride = (count + kMostMapPoints - 1) / kMostMapPoints;
  std::vector<Point> points;
  std::size_t number = 0;
  for (const LiveScene::Numbered& cloud : scene.clouds()) {
    for (const Point& point : points_of(cloud.cloud, cloud.placed.T_map_lidar)) {
      if (number++ % stride == 0) {
        points.push_back(point);
      }
    }
  }
  const Nanoseconds stamp = scene.span().last;
  return {kMapPointsTopic, stamp, point_cloud(stamp, kMapFrame, "", points)};
}

ShownMessage keyframe_points_of(const LiveScene::Numbered& cloud) {
  return {
      kKeyframePointsTopic, cloud.stamp,
      point_cloud(cloud.stamp, kMapFrame, "", points_of(cloud.cloud, cloud.placed.T_map_lidar))};
}

ShownMessage message_of(const LiveScene::Newest& sweep, Live what) {
  const auto& [number, placed, cloud, stamp, version] = sweep.shown;
  switch (what) {
    case Live::transform:
      return {kPoseTransformTopic, stamp,
              frame_transform(stamp, kMapFrame, kLidarFrame, placed.T_map_lidar)};
    case Live::pose:
      return {kPoseTopic, stamp, pose_in_frame(stamp, kMapFrame, placed.T_map_lidar)};
    case Live::sweep:
      return {kSweepTopic, stamp, sweep_message(sweep.record)};
    default:
      return {kLidarPointsTopic, stamp,
              point_cloud(stamp, kLidarFrame, "", points_of(cloud, Eigen::Isometry3d::Identity()))};
  }
}

ShownMessage graph_part_of(const LiveScene& scene, const std::string& topic) {
  return drawn_message(scene.span().last,
                       *std::ranges::find(scene.graph_parts(), topic, &ShownPart::topic));
}

}  // namespace

FoxgloveLiveFeed::FoxgloveLiveFeed(const LiveScene& scene) : scene_(&scene) {
  for (const ShownTopic& topic :
       {kLogTopic, kPoseTransformTopic, kPoseTopic, kSweepTopic, kLidarPointsTopic,
        kKeyframePointsTopic, kMapPointsTopic, ShownTopic{kTrajectoryTopic, kDrawnType}}) {
    channels_.push_back(foxglove_channel(topic));
  }
  for (const char* topic : kGraphTopics) {
    channels_.push_back(foxglove_channel({topic, kDrawnType}));
  }
}

std::optional<uint64_t> FoxgloveLiveFeed::next(std::size_t channel, uint64_t after) {
  const LiveScene::Versions& versions = scene_->versions();
  switch (kind_of(channel)) {
    case Live::log:
      return if_after(versions.doing, after);
    case Live::keyframe:
      return first_after(scene_->clouds(), after, version_of);
    case Live::map:
      return scene_->clouds().empty() ? std::nullopt : if_after(versions.clouds, after);
    case Live::trajectory:
      return scene_->poses().empty() ? std::nullopt : if_after(drawn_at(*scene_), after);
    case Live::graph:
      return scene_->graph_parts().empty() ? std::nullopt : if_after(versions.graph, after);
    default:
      return first_after(scene_->newest(), after, version_of_newest);
  }
}

FoxgloveMessage FoxgloveLiveFeed::map_points(uint64_t position) {
  if (map_position_ != position) {
    map_points_ = foxglove_message(map_points_of(*scene_));
    map_position_ = position;
  }
  return map_points_;
}

FoxgloveMessage FoxgloveLiveFeed::message(std::size_t channel, uint64_t position) {
  const Live what = kind_of(channel);
  const Nanoseconds last = scene_->span().last;
  switch (what) {
    case Live::log:
      return foxglove_message(
          {kLogTopic, last, log_message(last, ShownLevel::info, scene_->doing())});
    case Live::keyframe:
      return foxglove_message(keyframe_points_of(
          *std::ranges::find(scene_->clouds(), position, &LiveScene::Numbered::version)));
    case Live::map:
      return map_points(position);
    case Live::trajectory:
      return foxglove_message(trajectory_of(*scene_));
    case Live::graph:
      return foxglove_message(graph_part_of(*scene_, channels_[channel].topic));
    default:
      return foxglove_message(
          message_of(*std::ranges::find(scene_->newest(), position, version_of_newest), what));
  }
}

}  // namespace adit
