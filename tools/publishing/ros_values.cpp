// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/ros_values.hpp"

namespace adit {
namespace {

constexpr uint8_t kFloat32 = 7;  // of PointField

ros::Quaternion ros_quaternion(const Eigen::Isometry3d& T) {
  const Eigen::Quaterniond q(T.rotation());
  return {.x = q.x(), .y = q.y(), .z = q.z(), .w = q.w()};
}

ros::PointField float_field(const char* name, uint32_t offset) {
  ros::PointField field;
  field.name = name;
  field.offset = offset;
  field.datatype = kFloat32;
  return field;
}

}  // namespace

ros::Vector3 ros_vector(const Eigen::Vector3d& v) {
  return {.x = v.x(), .y = v.y(), .z = v.z()};
}

ros::Pose ros_pose(const Eigen::Isometry3d& T) {
  return {.position = ros_vector(T.translation()), .orientation = ros_quaternion(T)};
}

ros::Header ros_header(Nanoseconds stamp, const std::string& frame) {
  ros::Header header;
  header.stamp = stamp;
  header.frame = frame;
  return header;
}

ros::TransformStamped ros_transform(Nanoseconds stamp, const std::string& parent,
                                    const std::string& child, const Eigen::Isometry3d& T) {
  ros::TransformStamped transform;
  transform.header = ros_header(stamp, parent);
  transform.child_frame = child;
  transform.translation = ros_vector(T.translation());
  transform.rotation = ros_quaternion(T);
  return transform;
}

std::array<double, 36> ros_covariance(const Matrix6d& covariance) {
  std::array<double, 36> numbers{};
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(numbers.data()) = covariance;
  return numbers;
}

Matrix6d in_parent_axes(const Matrix6d& covariance, const Eigen::Matrix3d& R) {
  Matrix6d rotation = Matrix6d::Zero();
  rotation.topLeftCorner<3, 3>() = R;
  rotation.bottomRightCorner<3, 3>() = R;
  return rotation * covariance * rotation.transpose();
}

ros::PointCloud2 ros_cloud(Nanoseconds stamp, const std::string& frame,
                           std::span<const Point> points) {
  ros::PointCloud2 message;
  message.header = ros_header(stamp, frame);
  message.width = static_cast<uint32_t>(points.size());
  message.fields = {float_field("x", 0), float_field("y", 4), float_field("z", 8),
                    float_field("intensity", 12)};
  message.point_step = sizeof(Point);
  message.row_step = message.point_step * message.width;
  message.data = std::as_bytes(points);
  message.is_dense = true;
  return message;
}

}  // namespace adit
