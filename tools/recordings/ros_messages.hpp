// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The ROS messages that are understood, field by field as their public definitions have them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit::ros {

struct Header {
  uint32_t sequence = 0;  ///< ROS 1 only
  Nanoseconds stamp{0};
  std::string frame;
};

struct Vector3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

struct Quaternion {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double w = 1.0;
};

struct PointField {
  std::string name;
  uint32_t offset = 0;   ///< bytes from the start of the point
  uint8_t datatype = 0;  ///< 1 to 8: int8 uint8 int16 uint16 int32 uint32 float32 float64
  uint32_t count = 1;
};

struct PointCloud2 {
  static constexpr std::string_view kType = "sensor_msgs/PointCloud2";
  Header header;
  uint32_t height = 1;
  uint32_t width = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false;
  uint32_t point_step = 0;          ///< bytes from point to point
  uint32_t row_step = 0;            ///< bytes from row to row
  std::span<const std::byte> data;  ///< a view of the message that was read
  bool is_dense = false;
};

struct Imu {
  static constexpr std::string_view kType = "sensor_msgs/Imu";
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance{};
  Vector3 angular_velocity;
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration;
  std::array<double, 9> linear_acceleration_covariance{};
};

struct NavSatFix {
  static constexpr std::string_view kType = "sensor_msgs/NavSatFix";
  Header header;
  int8_t status = 0;  ///< -1 no fix, 0 fix, 1 satellite-based augmentation, 2 ground-based
  uint16_t service = 0;
  double latitude = 0.0;                        ///< degrees
  double longitude = 0.0;                       ///< degrees
  double altitude = 0.0;                        ///< m above the ellipsoid
  std::array<double, 9> position_covariance{};  ///< m², east north up
  uint8_t position_covariance_type = 0;         ///< 0: unknown
};

struct Pose {
  Vector3 position;
  Quaternion orientation;
};

struct Twist {
  Vector3 linear;   ///< m/s
  Vector3 angular;  ///< rad/s
};

struct TwistStamped {
  static constexpr std::string_view kType = "geometry_msgs/TwistStamped";
  Header header;
  Twist twist;
};

struct TwistWithCovarianceStamped {
  static constexpr std::string_view kType = "geometry_msgs/TwistWithCovarianceStamped";
  Header header;
  Twist twist;
  std::array<double, 36> covariance{};  ///< linear before angular, row by row
};

struct Odometry {
  static constexpr std::string_view kType = "nav_msgs/Odometry";
  Header header;
  std::string child_frame;
  Pose pose;
  std::array<double, 36> pose_covariance{};
  Vector3 linear{};
  Vector3 angular{};
  std::array<double, 36> twist_covariance{};
};

struct PoseStamped {
  static constexpr std::string_view kType = "geometry_msgs/PoseStamped";
  Header header;
  Pose pose;
};

struct QuaternionStamped {
  static constexpr std::string_view kType = "geometry_msgs/QuaternionStamped";
  Header header;
  Quaternion quaternion;
};

/// An NMEA 0183 sentence.
struct Sentence {
  static constexpr std::string_view kType = "nmea_msgs/Sentence";
  Header header;
  std::string sentence;
};

struct Path {
  static constexpr std::string_view kType = "nav_msgs/Path";
  Header header;
  std::vector<PoseStamped> poses;
};

/// Cells row by row, from the corner at `origin` on.
struct OccupancyGrid {
  static constexpr std::string_view kType = "nav_msgs/OccupancyGrid";
  Header header;
  Nanoseconds map_load_time{0};
  float resolution = 0.0F;  ///< m, edge of a cell
  uint32_t width = 0;       ///< cells
  uint32_t height = 0;      ///< cells
  Pose origin;
  std::span<const std::byte> data;  ///< int8: 0 free, 100 occupied, -1 unknown; a view
};

struct KeyValue {
  std::string key;
  std::string value;
};

struct DiagnosticStatus {
  uint8_t level = 0;  ///< 0 ok, 1 warning, 2 error, 3 stale
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;
};

struct DiagnosticArray {
  static constexpr std::string_view kType = "diagnostic_msgs/DiagnosticArray";
  Header header;
  std::vector<DiagnosticStatus> status;
};

struct TransformStamped {
  static constexpr std::string_view kType = "geometry_msgs/TransformStamped";
  Header header;
  std::string child_frame;
  Vector3 translation;
  Quaternion rotation;
};

struct TFMessage {
  static constexpr std::string_view kType = "tf2_msgs/TFMessage";
  std::vector<TransformStamped> transforms;
};

struct LivoxPoint {
  uint32_t offset_time = 0;  ///< ns after the message's timebase
  float x = 0.0F;
  float y = 0.0F;
  float z = 0.0F;
  uint8_t reflectivity = 0;
  uint8_t tag = 0;  ///< bits 4 and 5: confidence in the return
  uint8_t line = 0;
};

struct LivoxCustomMsg {
  static constexpr std::string_view kType = "livox_ros_driver2/CustomMsg";
  Header header;
  uint64_t timebase = 0;  ///< ns
  uint32_t point_num = 0;
  uint8_t lidar_id = 0;
  std::array<uint8_t, 3> reserved{};
  std::vector<LivoxPoint> points;
};

struct VelodynePacket {
  Nanoseconds stamp{0};
  std::array<uint8_t, 1206> data{};
};

struct VelodyneScan {
  static constexpr std::string_view kType = "velodyne_msgs/VelodyneScan";
  Header header;
  std::vector<VelodynePacket> packets;
};

/// A packet of an Ouster; its packages are ouster_ros, ouster_msgs or ouster_sensor_msgs.
struct PacketMsg {
  static constexpr std::string_view kType = "ouster_ros/PacketMsg";
  std::span<const std::byte> data;  ///< a view of the message that was read
};

/// std_msgs/String.
struct String {
  static constexpr std::string_view kType = "std_msgs/String";
  std::string data;
};

struct Image {
  static constexpr std::string_view kType = "sensor_msgs/Image";
  Header header;
  uint32_t height = 0;   ///< pixels
  uint32_t width = 0;    ///< pixels
  std::string encoding;  ///< "16UC1", "32FC1", "rgb8" ...
  uint8_t is_bigendian = 0;
  uint32_t step = 0;                ///< bytes from row to row
  std::span<const std::byte> data;  ///< a view of the message that was read
};

struct CompressedImage {
  static constexpr std::string_view kType = "sensor_msgs/CompressedImage";
  Header header;
  std::string format;               ///< "jpeg", "png", "rgb8; jpeg compressed bgr8" ...
  std::span<const std::byte> data;  ///< a view of the message that was read
};

struct CameraInfo {
  static constexpr std::string_view kType = "sensor_msgs/CameraInfo";
  Header header;
  uint32_t height = 0;           ///< pixels, of the whole sensor
  uint32_t width = 0;            ///< pixels, of the whole sensor
  std::string distortion_model;  ///< "plumb_bob", "rational_polynomial" ...
  std::vector<double> d;         ///< distortion
  std::array<double, 9> k{};     ///< raw image's camera matrix, row by row
  std::array<double, 9> r{};     ///< rectification
  std::array<double, 12> p{};    ///< rectified image's projection, row by row
  uint32_t binning_x = 0;        ///< 0 and 1: none
  uint32_t binning_y = 0;
  uint32_t x_offset = 0;  ///< region of interest, whole pixels
  uint32_t y_offset = 0;
  uint32_t roi_height = 0;  ///< 0: all
  uint32_t roi_width = 0;
  bool do_rectify = false;
};

}  // namespace adit::ros
