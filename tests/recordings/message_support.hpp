// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Messages of every type that is understood, and small recordings of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "adit/tests/recordings/packet_support.hpp"
#include "adit/tools/containers/message_writer.hpp"
#include "adit/tools/containers/ros_definitions.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit::test {

inline constexpr Nanoseconds kStart{1623370000000000000};

inline ros::Header header(uint32_t i, const std::string& frame) {
  return {.sequence = i, .stamp = kStart + Nanoseconds(100000000 * i + 7), .frame = frame};
}

inline ros::Imu imu_message(uint32_t i) {
  ros::Imu imu;
  imu.header = header(i, "imu");
  imu.orientation_covariance[0] = -1.0;
  imu.angular_velocity = {0.01 * i, -0.02, 0.03};
  imu.linear_acceleration = {0.1, 0.2 * i, 9.81};
  imu.linear_acceleration_covariance[8] = 1e-3;
  return imu;
}

/// Two points with intensity, ring and time; `data` is what the message views.
struct CloudExample {
  std::vector<std::byte> data;
  ros::PointCloud2 message;
};
inline CloudExample cloud_message(uint32_t i) {
  struct Packed {
    float x, y, z, intensity, time;
    uint16_t ring, unused;
  };
  static_assert(sizeof(Packed) == 24);
  const std::array<Packed, 2> points = {
      {{1.0F + static_cast<float>(i), 2.0F, 3.0F, 0.5F, 0.0F, 4, 0},
       {-1.0F, -2.0F, -3.0F, 0.25F, 0.05F, 5, 0}}};
  CloudExample cloud;
  cloud.data.resize(sizeof points);
  std::memcpy(cloud.data.data(), points.data(), sizeof points);
  cloud.message.header = header(i, "os_sensor");
  cloud.message.width = 2;
  cloud.message.fields = {{"x", 0, 7, 1},          {"y", 4, 7, 1},     {"z", 8, 7, 1},
                          {"intensity", 12, 7, 1}, {"time", 16, 7, 1}, {"ring", 20, 4, 1}};
  cloud.message.point_step = 24;
  cloud.message.row_step = 48;
  cloud.message.data = cloud.data;
  return cloud;
}

inline ros::NavSatFix fix_message(uint32_t i) {
  ros::NavSatFix fix;
  fix.header = header(i, "gnss");
  fix.status = 2;
  fix.service = 1;
  fix.latitude = 41.65;
  fix.longitude = -0.88 + 1e-6 * i;
  fix.altitude = 220.5;
  fix.position_covariance = {0.04, 0.001, 0, 0.001, 0.05, 0, 0, 0, 0.2};
  fix.position_covariance_type = 3;
  return fix;
}

inline ros::Odometry odometry_message(uint32_t i) {
  ros::Odometry odometry;
  odometry.header = header(i, "odom");
  odometry.child_frame = "base_link";
  odometry.pose = {{0.5 * i, 1.0, -2.0}, {0.0, 0.0, 0.6, 0.8}};
  odometry.pose_covariance[35] = 0.01;
  odometry.linear = {5.0, 0.0, 0.0};
  odometry.angular = {0.0, 0.0, 0.1};
  return odometry;
}

inline ros::TwistStamped twist_message(uint32_t i) {
  return {.header = header(i, "radar"), .twist = {{1.5, -0.25, 0.125 * i}, {0.0, 0.0, 0.5}}};
}

inline ros::TwistWithCovarianceStamped twist_with_covariance_message(uint32_t i) {
  ros::TwistWithCovarianceStamped twist;
  twist.header = header(i, "wheels");
  twist.twist = {{2.0, 0.0, 0.0625 * i}, {0.0, 0.0, -0.5}};
  for (std::size_t k = 0; k < twist.covariance.size(); ++k) {
    twist.covariance[k] = k % 7 == 0 ? 0.01 + 0.01 * static_cast<double>(k) : 0.001;
  }
  return twist;
}

inline ros::QuaternionStamped quaternion_message(uint32_t i) {
  return {.header = header(i, "antenna"), .quaternion = {0.0, 0.0, 0.6, 0.8}};
}

inline ros::Sentence sentence_message(uint32_t i) {
  return {.header = header(i, "antenna"), .sentence = "$GPHDT,274.07,T*03"};
}

inline ros::PoseStamped pose_message(uint32_t i) {
  return {.header = header(i, "map"), .pose = {{1.0, 2.0, 0.25 * i}, {0.5, 0.5, 0.5, 0.5}}};
}

inline ros::TransformStamped transform_message(uint32_t i, const std::string& child) {
  return {.header = header(i, "base_link"),
          .child_frame = child,
          .translation = {0.1, -0.2, 0.3},
          .rotation = {0.0, 0.0, 1.0, 0.0}};
}

inline ros::LivoxCustomMsg livox_message(uint32_t i) {
  ros::LivoxCustomMsg message;
  message.header = header(i, "livox_frame");
  message.timebase = static_cast<uint64_t>(message.header.stamp.count());
  message.point_num = 3;
  message.lidar_id = 1;
  message.points = {{1000, 1.0F, 2.0F, 3.0F, 40, 0x10, 1},
                    {2000, 4.0F, 5.0F, 6.0F, 50, 0x20, 2},  // noise
                    {50000, 7.0F, 8.0F, 9.0F, 60, 0x00, 3}};
  return message;
}

/// 3 x 2 pixels, the first without a return, rows of 8 bytes; `data` is what the message views.
struct ImageExample {
  std::vector<std::byte> data;
  ros::Image message;
};
inline ImageExample depth_image_message(uint32_t i) {
  const std::array<uint16_t, 8> millimetres = {0, 1000, 2000, 99, 500, 1500, 65535, 99};
  ImageExample image;
  image.data.resize(sizeof millimetres);
  std::memcpy(image.data.data(), millimetres.data(), sizeof millimetres);
  image.message.header = header(i, "camera_depth_optical_frame");
  image.message.height = 2;
  image.message.width = 3;
  image.message.encoding = "16UC1";
  image.message.step = 8;
  image.message.data = image.data;
  return image;
}

inline ros::CameraInfo camera_info_message(uint32_t i) {
  ros::CameraInfo info;
  info.header = header(i, "camera_depth_optical_frame");
  info.height = 2;
  info.width = 3;
  info.distortion_model = "plumb_bob";
  info.d = {0.0, 0.0, 0.0, 0.0, 0.0};
  info.k = {100.0, 0.0, 1.0, 0.0, 200.0, 0.5, 0.0, 0.0, 1.0};
  info.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.p = {50.0, 0.0, 1.0, 0.0, 0.0, 60.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

/// A turn of a VLP-16 in packets of 15 degrees, as its driver publishes it: laser i measures
/// 10 + 0.1 i m. It begins at azimuth 350.
inline ros::VelodyneScan velodyne_message(uint32_t i, std::size_t packets = 24) {
  ros::VelodyneScan scan;
  scan.header = header(i, "velodyne");
  for (std::size_t k = 0; k < packets; ++k) {
    const Bytes bytes =
        velodyne_packet(std::fmod(350.0 + 15.0 * static_cast<double>(k), 360.0), 1.25,
                        static_cast<uint32_t>(1327 * k), 0x37, 0x22,
                        [](std::size_t, std::size_t laser) { return 5000 + 50 * (laser % 16); });
    ros::VelodynePacket packet{.stamp = scan.header.stamp + Nanoseconds(1327104 * k)};
    std::memcpy(packet.data.data(), bytes.data(), packet.data.size());
    scan.packets.push_back(packet);
  }
  return scan;
}

/// A message on a topic, to be written.
struct SampleMessage {
  std::size_t channel = 0;  ///< index into sample_channels()
  Nanoseconds received{0};
  std::vector<std::byte> bytes;
};

inline std::vector<Channel> sample_channels(Encoding encoding) {
  std::vector<Channel> channels;
  const auto add = [&](const char* topic, std::string_view type) {
    channels.push_back({.topic = topic,
                        .type = std::string(type),
                        .encoding = encoding,
                        .definition = ros::definition_of(type, encoding).value().text,
                        .messages = std::nullopt});
  };
  add("/points", ros::PointCloud2::kType);
  add("/imu", ros::Imu::kType);
  add("/fix", ros::NavSatFix::kType);
  add("/odom", ros::Odometry::kType);
  add("/pose", ros::PoseStamped::kType);
  add("/vicon", ros::TransformStamped::kType);
  add("/tf_static", ros::TFMessage::kType);
  add("/livox", ros::LivoxCustomMsg::kType);
  return channels;
}

/// `rounds` messages of every type but /tf_static, which has one.
inline std::vector<SampleMessage> sample_messages(Encoding encoding, uint32_t rounds) {
  std::vector<SampleMessage> messages;
  for (uint32_t i = 0; i < rounds; ++i) {
    const auto add = [&](std::size_t channel, const auto& message) {
      const Nanoseconds received =
          header(i, "").stamp + Nanoseconds(1000000 * static_cast<int64_t>(channel + 1));
      messages.push_back({channel, received, ros::encode(encoding, message)});
    };
    add(0, cloud_message(i).message);
    add(1, imu_message(i));
    add(2, fix_message(i));
    add(3, odometry_message(i));
    add(4, pose_message(i));
    add(5, transform_message(i, "vicon"));
    if (i == 0) {
      add(6, ros::TFMessage{{transform_message(i, "lidar"), transform_message(i, "imu")}});
    }
    add(7, livox_message(i));
  }
  return messages;
}

/// Without definitions the file is small.
inline void write_sample(MessageWriter& writer, Encoding encoding, uint32_t rounds,
                         bool definitions = true) {
  std::vector<std::size_t> ids;
  for (Channel channel : sample_channels(encoding)) {
    if (!definitions) {
      channel.definition.clear();
    }
    ids.push_back(writer.add_channel(channel));
  }
  for (const SampleMessage& message : sample_messages(encoding, rounds)) {
    writer.write(ids[message.channel], message.received, message.bytes);
  }
}

/// `rounds` depth images and their calibration, on the topic `images` and camera_info beside it.
inline void write_depth_sample(MessageWriter& writer, Encoding encoding, const std::string& images,
                               uint32_t rounds) {
  const auto add = [&](const std::string& topic, std::string_view type) {
    return writer.add_channel({.topic = topic,
                               .type = std::string(type),
                               .encoding = encoding,
                               .definition = {},
                               .messages = std::nullopt});
  };
  const std::size_t image = add(images, ros::Image::kType);
  const std::size_t info =
      add(images.substr(0, images.rfind('/') + 1) + "camera_info", ros::CameraInfo::kType);
  for (uint32_t i = 0; i < rounds; ++i) {
    const Nanoseconds received = header(i, "").stamp;
    writer.write(image, received, ros::encode(encoding, depth_image_message(i).message));
    writer.write(info, received, ros::encode(encoding, camera_info_message(i)));
  }
}

}  // namespace adit::test
