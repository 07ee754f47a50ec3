// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/map_publisher.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "adit/tools/publishing/ros_values.hpp"
#include "adit/tools/recordings/ros_visit.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Clock::duration kBetweenReads = std::chrono::seconds(1);
constexpr Clock::duration kBetweenMaps = std::chrono::seconds(5);
constexpr int kShare = 10;  // of the time goes by between readings, for each of them
constexpr auto kLookEvery = std::chrono::milliseconds(50);
constexpr double kGridReach = 100.0;  // m

}  // namespace

MapPublisher::MapPublisher(DdsNode& node, std::string map_frame)
    : node_(node),
      frame_(std::move(map_frame)),
      path_topic_(node.advertise({.name = "/adit/path",
                                  .type = std::string(ros::Path::kType),
                                  .reliable = true,
                                  .latched = true})),
      map_topic_(node.advertise({.name = "/adit/map",
                                 .type = std::string(ros::PointCloud2::kType),
                                 .reliable = true,
                                 .latched = true})),
      grid_topic_(node.advertise({.name = "/adit/occupancy_grid",
                                  .type = std::string(ros::OccupancyGrid::kType),
                                  .reliable = true,
                                  .latched = true})) {}

void MapPublisher::begin(const std::filesystem::path& map, const Eigen::Isometry3d& T_lidar_base) {
  end();
  T_lidar_base_ = T_lidar_base;
  thread_ = std::jthread([this, map](const std::stop_token& stop) { follow(map, stop); });
}

void MapPublisher::end() {
  thread_.request_stop();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void MapPublisher::follow(const std::filesystem::path& map, const std::stop_token& stop) {
  LiveMap live;
  bool points_are_new = false;
  Clock::time_point published = Clock::now() - kBetweenMaps;
  bool last = false;
  while (!last) {
    last = stop.stop_requested();
    const auto begun = Clock::now();
    try {
      const LiveMapChange change = live.read(map, [&] { return !last && stop.stop_requested(); });
      points_are_new = points_are_new || change.points;
      if (change.keyframes) {
        publish_path(live);
      }
    } catch (const FileError&) {
      // What was read before stays; if the map is damaged, the run itself reports it.
    }
    if (points_are_new && !live.keyframes().empty() &&
        (last || Clock::now() - published >= kBetweenMaps)) {
      publish_points(live);
      publish_grid(live);
      points_are_new = false;
      published = Clock::now();
    }
    const auto next = Clock::now() + std::max(kBetweenReads, kShare * (Clock::now() - begun));
    while (!stop.stop_requested() && Clock::now() < next) {
      std::this_thread::sleep_for(kLookEvery);
    }
  }
}

void MapPublisher::publish_path(const LiveMap& map) {
  ros::Path path;
  for (const LiveKeyframe& keyframe : map.keyframes()) {
    ros::PoseStamped pose;
    pose.header = ros_header(keyframe.stamp, frame_);
    pose.pose = ros_pose(keyframe.T_map_lidar * T_lidar_base_);
    path.poses.push_back(std::move(pose));
  }
  path.header =
      ros_header(path.poses.empty() ? Nanoseconds(0) : path.poses.back().header.stamp, frame_);
  node_.publish(path_topic_, ros::encode(Encoding::cdr, path));
}

void MapPublisher::publish_points(const LiveMap& map) {
  const Nanoseconds stamp = map.keyframes().back().stamp;
  node_.publish(map_topic_, ros::encode(Encoding::cdr, ros_cloud(stamp, frame_, map.points())));
}

void MapPublisher::publish_grid(const LiveMap& map) {
  const LiveKeyframe& last = map.keyframes().back();
  const OccupancyCells cells =
      map.grid().cells_around(last.T_map_lidar.translation().head<2>(), kGridReach);
  ros::OccupancyGrid message;
  message.header = ros_header(last.stamp, frame_);
  message.map_load_time = last.stamp;
  message.resolution = static_cast<float>(map.grid().cell());
  message.width = static_cast<uint32_t>(cells.columns);
  message.height = static_cast<uint32_t>(cells.rows);
  message.origin.position = {.x = cells.origin.x(), .y = cells.origin.y(), .z = 0.0};
  message.data = std::as_bytes(std::span(cells.values));
  node_.publish(grid_topic_, ros::encode(Encoding::cdr, message));
}

}  // namespace adit
