// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/motion_publisher.hpp"

#include <memory>
#include <utility>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/publishing/ros_values.hpp"
#include "adit/tools/recordings/ros_visit.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kKept = std::chrono::seconds(1);  // by which readings are compared

}  // namespace

MotionPublisher::MotionPublisher(DdsNode& node)
    : node_(node),
      topic_(node.advertise({.name = "/adit/odometry_high_rate",
                             .type = std::string(ros::Odometry::kType),
                             .reliable = true})) {}

void MotionPublisher::begin(PublishedMotion source) {
  end();
  source_ = std::move(source);
  stream_.emplace(source_.config, 0.0);
  ages_ = {};
}

void MotionPublisher::update(const InertialReport& report) {
  if (!stream_) {
    return;
  }
  {
    const std::scoped_lock lock(mutex_);
    stream_->update(report);
  }
  if (report.nav && !thread_.joinable()) {
    thread_ = std::jthread([this](const std::stop_token& stop) { follow(stop); });
  }
}

void MotionPublisher::end() {
  thread_.request_stop();
  if (thread_.joinable()) {
    thread_.join();
  }
  stream_.reset();
}

void MotionPublisher::follow(const std::stop_token& stop) {
  const auto events = source_.recording->events({.topics = {source_.topic}});
  ImuBuffer readings;
  while (!stop.stop_requested()) {
    std::optional<Event> event;
    try {
      event = events->next();
    } catch (const InputError&) {
      continue;  // the run itself reports the damage
    }
    const auto* reading = event ? std::get_if<ImuSample>(&event->value) : nullptr;
    if (!event) {
      return;
    }
    if (reading == nullptr) {
      continue;
    }
    const ImuArrival arrival = readings.push(*reading);
    readings.forget_before(reading->stamp - kKept);
    std::optional<LidarMotion> motion;
    {
      const std::scoped_lock lock(mutex_);
      motion = stream_->add(*reading, arrival);
    }
    if (motion) {
      publish(*motion);
      const std::chrono::duration<double, std::milli> age =
          std::chrono::system_clock::now() - source_.arrival(event->received);
      const std::scoped_lock lock(mutex_);
      ages_.add(age.count());
    }
  }
}

void MotionPublisher::publish(const LidarMotion& motion) {
  const Eigen::Isometry3d& T_lidar_base = source_.T_lidar_base;
  const Eigen::Matrix3d R_base_lidar = T_lidar_base.linear().transpose();
  const Eigen::Isometry3d T_odom_base = motion.T_map_lidar * T_lidar_base;
  const Matrix6d to_base = adjoint(T_lidar_base.inverse());
  const Matrix6d pose = to_base * motion.covariance.topLeftCorner<6, 6>() * to_base.transpose();
  const Eigen::Matrix3d R_base_map = T_odom_base.linear().transpose();
  Matrix6d twist = Matrix6d::Zero();  // of the rates the sensor states nothing
  twist.topLeftCorner<3, 3>() =
      R_base_map * motion.covariance.bottomRightCorner<3, 3>() * R_base_map.transpose();
  ros::Odometry message;
  message.header = ros_header(motion.stamp, source_.odom_frame);
  message.child_frame = source_.base_frame;
  message.pose = ros_pose(T_odom_base);
  message.pose_covariance = ros_covariance(in_parent_axes(pose, T_odom_base.linear()));
  message.linear =
      ros_vector(R_base_map * motion.v_map_lidar +
                 R_base_lidar * motion.angular_velocity.cross(T_lidar_base.translation()));
  message.angular = ros_vector(R_base_lidar * motion.angular_velocity);
  message.twist_covariance = ros_covariance(twist);
  node_.publish(topic_, ros::encode(Encoding::cdr, message));
}

DurationSample MotionPublisher::ages() const {
  const std::scoped_lock lock(mutex_);
  return ages_;
}

}  // namespace adit
