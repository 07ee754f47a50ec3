// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// visit() names a message's fields in their order; Decoder and Encoder do the same with them.
#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_messages.hpp"

namespace adit::ros {

/// T to read, T or const T to write.
template <class M, class T>
concept IsA = std::same_as<std::remove_const_t<M>, T>;

template <class Archive>
void visit(Archive& archive, IsA<Header> auto& header) {
  if (archive.encoding() == Encoding::ros1) {
    archive(header.sequence);
  }
  archive.time(header.stamp);
  archive(header.frame);
}

template <class Archive>
void visit(Archive& archive, IsA<Vector3> auto& v) {
  archive(v.x, v.y, v.z);
}

template <class Archive>
void visit(Archive& archive, IsA<Quaternion> auto& q) {
  archive(q.x, q.y, q.z, q.w);
}

template <class Archive>
void visit(Archive& archive, IsA<Pose> auto& pose) {
  visit(archive, pose.position);
  visit(archive, pose.orientation);
}

template <class Archive>
void visit(Archive& archive, IsA<Twist> auto& twist) {
  visit(archive, twist.linear);
  visit(archive, twist.angular);
}

template <class Archive>
void visit(Archive& archive, IsA<TwistStamped> auto& message) {
  visit(archive, message.header);
  visit(archive, message.twist);
}

template <class Archive>
void visit(Archive& archive, IsA<TwistWithCovarianceStamped> auto& message) {
  visit(archive, message.header);
  visit(archive, message.twist);
  archive(message.covariance);
}

template <class Archive>
void visit(Archive& archive, IsA<QuaternionStamped> auto& message) {
  visit(archive, message.header);
  visit(archive, message.quaternion);
}

template <class Archive>
void visit(Archive& archive, IsA<Sentence> auto& message) {
  visit(archive, message.header);
  archive(message.sentence);
}

template <class Archive>
void visit(Archive& archive, IsA<PointField> auto& field) {
  archive(field.name, field.offset, field.datatype, field.count);
}

template <class Archive>
void visit(Archive& archive, IsA<PointCloud2> auto& cloud) {
  visit(archive, cloud.header);
  archive(cloud.height, cloud.width);
  archive.sequence(cloud.fields, 13, [](auto& a, auto& field) { visit(a, field); });
  archive(cloud.is_bigendian, cloud.point_step, cloud.row_step);
  archive.blob(cloud.data);
  archive(cloud.is_dense);
}

template <class Archive>
void visit(Archive& archive, IsA<Imu> auto& imu) {
  visit(archive, imu.header);
  visit(archive, imu.orientation);
  archive(imu.orientation_covariance);
  visit(archive, imu.angular_velocity);
  archive(imu.angular_velocity_covariance);
  visit(archive, imu.linear_acceleration);
  archive(imu.linear_acceleration_covariance);
}

template <class Archive>
void visit(Archive& archive, IsA<NavSatFix> auto& fix) {
  visit(archive, fix.header);
  archive(fix.status, fix.service, fix.latitude, fix.longitude, fix.altitude,
          fix.position_covariance, fix.position_covariance_type);
}

template <class Archive>
void visit(Archive& archive, IsA<Odometry> auto& odometry) {
  visit(archive, odometry.header);
  archive(odometry.child_frame);
  visit(archive, odometry.pose);
  archive(odometry.pose_covariance);
  visit(archive, odometry.linear);
  visit(archive, odometry.angular);
  archive(odometry.twist_covariance);
}

template <class Archive>
void visit(Archive& archive, IsA<PoseStamped> auto& pose) {
  visit(archive, pose.header);
  visit(archive, pose.pose);
}

template <class Archive>
void visit(Archive& archive, IsA<Path> auto& path) {
  visit(archive, path.header);
  archive.sequence(path.poses, 68, [](auto& a, auto& pose) { visit(a, pose); });
}

template <class Archive>
void visit(Archive& archive, IsA<OccupancyGrid> auto& grid) {
  visit(archive, grid.header);
  archive.time(grid.map_load_time);
  archive(grid.resolution, grid.width, grid.height);
  visit(archive, grid.origin);
  archive.blob(grid.data);
}

template <class Archive>
void visit(Archive& archive, IsA<DiagnosticStatus> auto& status) {
  archive(status.level, status.name, status.message, status.hardware_id);
  archive.sequence(status.values, 8, [](auto& a, auto& pair) { a(pair.key, pair.value); });
}

template <class Archive>
void visit(Archive& archive, IsA<DiagnosticArray> auto& diagnostics) {
  visit(archive, diagnostics.header);
  archive.sequence(diagnostics.status, 17, [](auto& a, auto& status) { visit(a, status); });
}

template <class Archive>
void visit(Archive& archive, IsA<TransformStamped> auto& transform) {
  visit(archive, transform.header);
  archive(transform.child_frame);
  visit(archive, transform.translation);
  visit(archive, transform.rotation);
}

template <class Archive>
void visit(Archive& archive, IsA<TFMessage> auto& message) {
  archive.sequence(message.transforms, 72, [](auto& a, auto& transform) { visit(a, transform); });
}

template <class Archive>
void visit(Archive& archive, IsA<LivoxPoint> auto& point) {
  archive(point.offset_time, point.x, point.y, point.z, point.reflectivity, point.tag, point.line);
}

template <class Archive>
void visit(Archive& archive, IsA<LivoxCustomMsg> auto& message) {
  visit(archive, message.header);
  archive(message.timebase, message.point_num, message.lidar_id, message.reserved);
  archive.sequence(message.points, 19, [](auto& a, auto& point) { visit(a, point); });
}

template <class Archive>
void visit(Archive& archive, IsA<VelodynePacket> auto& packet) {
  archive.time(packet.stamp);
  archive(packet.data);
}

template <class Archive>
void visit(Archive& archive, IsA<VelodyneScan> auto& scan) {
  visit(archive, scan.header);
  archive.sequence(scan.packets, 1214, [](auto& a, auto& packet) { visit(a, packet); });
}

template <class Archive>
void visit(Archive& archive, IsA<PacketMsg> auto& packet) {
  archive.blob(packet.data);
}

template <class Archive>
void visit(Archive& archive, IsA<String> auto& text) {
  archive(text.data);
}

template <class Archive>
void visit(Archive& archive, IsA<Image> auto& image) {
  visit(archive, image.header);
  archive(image.height, image.width, image.encoding, image.is_bigendian, image.step);
  archive.blob(image.data);
}

template <class Archive>
void visit(Archive& archive, IsA<CompressedImage> auto& image) {
  visit(archive, image.header);
  archive(image.format);
  archive.blob(image.data);
}

template <class Archive>
void visit(Archive& archive, IsA<CameraInfo> auto& info) {
  visit(archive, info.header);
  archive(info.height, info.width, info.distortion_model);
  archive.sequence(info.d, 8, [](auto& a, auto& number) { a(number); });
  archive(info.k, info.r, info.p, info.binning_x, info.binning_y, info.x_offset, info.y_offset,
          info.roi_height, info.roi_width, info.do_rectify);
}

/// Throws CodecError where the bytes are no such message.
template <class Message>
Message decode(Encoding encoding, std::span<const std::byte> bytes) {
  Decoder decoder(encoding, bytes);
  Message message;
  visit(decoder, message);
  return message;
}

/// Throws CodecError where the encoding cannot hold the message.
template <class Message>
std::vector<std::byte> encode(Encoding encoding, const Message& message) {
  Encoder encoder(encoding);
  visit(encoder, message);
  return std::move(encoder).take();
}

}  // namespace adit::ros
