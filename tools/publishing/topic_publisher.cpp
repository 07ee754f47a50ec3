// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/topic_publisher.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/publishing/ros_values.hpp"
#include "adit/tools/recordings/ros_visit.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr auto kDiagnosticsEvery = std::chrono::seconds(1);

}  // namespace

TopicPublisher::TopicPublisher(DdsNode& node, RosFrames frames)
    : node_(node),
      wanted_(std::move(frames)),
      odometry_topic_(node.advertise(
          {.name = "/adit/odometry", .type = std::string(ros::Odometry::kType), .reliable = true})),
      transforms_topic_(node.advertise(
          {.name = "/tf", .type = std::string(ros::TFMessage::kType), .reliable = true})),
      cloud_topic_(node.advertise({.name = "/adit/keyframe_cloud",
                                   .type = std::string(ros::PointCloud2::kType),
                                   .reliable = true})),
      diagnostics_topic_(node.advertise({.name = "/diagnostics",
                                         .type = std::string(ros::DiagnosticArray::kType),
                                         .reliable = true})) {}

void TopicPublisher::begin(const FrameTree& transforms, const std::string& lidar_frame) {
  frames_ = wanted_;
  T_lidar_base_.setIdentity();
  T_map_odom_.setIdentity();
  last_.reset();
  if (frames_.base.empty() || frames_.base == lidar_frame) {
    frames_.base = lidar_frame.empty() ? "lidar" : lidar_frame;
    return;
  }
  const auto found = transforms.transform(lidar_frame, frames_.base);
  if (!found) {
    throw InputError(
        "--base-frame " + frames_.base, {},
        "no static transform connects it with the lidar's frame '" + lidar_frame + "'",
        "Publish it on /tf_static, or leave the option out: the lidar's frame is used");
  }
  T_lidar_base_ = *found;
}

void TopicPublisher::publish(const Sweep& sweep, const SweepResult& result) {
  const Eigen::Isometry3d T_odom_base = result.T_map_lidar * T_lidar_base_;
  ++sweeps_;
  unaligned_ += result.state == OdometryState::coasting ? 1U : 0U;
  publish_odometry(result, T_odom_base);
  publish_transforms(sweep.stamp, T_odom_base);
  publish_diagnostics(result);
}

void TopicPublisher::publish_odometry(const SweepResult& result,
                                      const Eigen::Isometry3d& T_odom_base) {
  // Seen from the base, the lidar's perturbation is that of another point of the same body.
  const Matrix6d to_base = adjoint(T_lidar_base_.inverse());
  const auto at_base = [&](const Matrix6d& covariance) {
    return Matrix6d(to_base * covariance * to_base.transpose());
  };
  ros::Odometry message;
  message.header = ros_header(result.stamp, frames_.odom);
  message.child_frame = frames_.base;
  message.pose = ros_pose(T_odom_base);
  message.pose_covariance =
      ros_covariance(in_parent_axes(at_base(result.uncertainty.in_map()), T_odom_base.rotation()));
  if (last_ && result.stamp > last_->stamp) {
    const double step = std::chrono::duration<double>(result.stamp - last_->stamp).count();
    const Vector6d moved = se3_log(last_->T_map_lidar.inverse() * T_odom_base) / step;
    message.linear = ros_vector(moved.head<3>());
    message.angular = ros_vector(moved.tail<3>());
    // Both ends are as well known as their submap makes them.
    message.twist_covariance = ros_covariance(
        at_base(result.uncertainty.local + last_->uncertainty.local) / (step * step));
  }
  last_ = {.stamp = result.stamp, .T_map_lidar = T_odom_base, .uncertainty = result.uncertainty};
  node_.publish(odometry_topic_, ros::encode(Encoding::cdr, message));
}

void TopicPublisher::publish_transforms(Nanoseconds stamp, const Eigen::Isometry3d& T_odom_base) {
  node_.publish(
      transforms_topic_,
      ros::encode(Encoding::cdr,
                  ros::TFMessage{{ros_transform(stamp, frames_.map, frames_.odom, T_map_odom_),
                                  ros_transform(stamp, frames_.odom, frames_.base, T_odom_base)}}));
}

void TopicPublisher::publish_diagnostics(const SweepResult& result) {
  if (diagnosed_ && result.stamp - *diagnosed_ < kDiagnosticsEvery) {
    return;
  }
  diagnosed_ = result.stamp;
  const bool aligned = result.state == OdometryState::tracking;
  const bool begins = result.state == OdometryState::initializing;
  ros::DiagnosticStatus status;
  status.level = aligned || begins ? 0 : 2;
  status.name = "adit: odometry";
  status.message = to_string(result.state);
  status.hardware_id = "adit";
  status.values = {{"sweeps", std::to_string(sweeps_)},
                   {"sweeps not aligned", std::to_string(unaligned_)},
                   {"points after down-sampling", std::to_string(result.cloud_points)}};
  ros::DiagnosticArray message;
  message.header = ros_header(result.stamp, "");
  message.status = {status};
  node_.publish(diagnostics_topic_, ros::encode(Encoding::cdr, message));
}

void TopicPublisher::publish(const SweepPlaced& placed) {
  if (placed.mapped) {
    T_map_odom_ = placed.mapped->T_map_lidar * placed.result.T_map_lidar.inverse();
  }
  if (!placed.result.keyframe) {
    return;
  }
  publish_cloud(placed.result, T_map_odom_ * placed.result.T_map_lidar);
}

void TopicPublisher::publish_cloud(const SweepResult& result,
                                   const Eigen::Isometry3d& T_map_lidar) {
  std::vector<Point> points = result.cloud;
  for (Point& point : points) {
    const Eigen::Vector3f moved =
        (T_map_lidar * Eigen::Vector3f(point.x, point.y, point.z).cast<double>()).cast<float>();
    point = {.x = moved.x(), .y = moved.y(), .z = moved.z(), .intensity = point.intensity};
  }
  node_.publish(cloud_topic_,
                ros::encode(Encoding::cdr, ros_cloud(result.stamp, frames_.map, points)));
}

}  // namespace adit
