// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/ros_definitions.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace adit::ros {
namespace {

/// A type: its fields, and the types in it, each also that of a field further down.
struct Type {
  std::string_view name;
  std::string_view fields;
  std::vector<std::string_view> parts;
  std::string_view md5;  // ROS 1; of the types that messages consist of
};

constexpr std::string_view kHeader = "std_msgs/Header";
constexpr std::string_view kTime = "builtin_interfaces/Time";
constexpr std::string_view kVector = "geometry_msgs/Vector3";
constexpr std::string_view kPoint = "geometry_msgs/Point";
constexpr std::string_view kQuaternion = "geometry_msgs/Quaternion";
constexpr std::string_view kPose = "geometry_msgs/Pose";
constexpr std::string_view kTransform = "geometry_msgs/Transform";
constexpr std::string_view kCameraInfo = "sensor_msgs/CameraInfo";
constexpr std::string_view kTransformStamped = "geometry_msgs/TransformStamped";

const std::vector<Type>& types() {
  static const std::vector<Type> kTypes = {
      {kHeader, "", {}, ""},  // differs between ROS 1 and ROS 2: see fields_of()
      {kTime, "int32 sec\nuint32 nanosec\n", {}, ""},
      {kVector, "float64 x\nfloat64 y\nfloat64 z\n", {}, ""},
      {kPoint, "float64 x\nfloat64 y\nfloat64 z\n", {}, ""},
      {kQuaternion, "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n", {}, ""},
      {kPose,
       "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
       {kPoint, kQuaternion},
       ""},
      {"geometry_msgs/PoseWithCovariance",
       "geometry_msgs/Pose pose\nfloat64[36] covariance\n",
       {kPose, kPoint, kQuaternion},
       ""},
      {"geometry_msgs/Twist",
       "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
       {kVector},
       ""},
      {"geometry_msgs/TwistWithCovariance",
       "geometry_msgs/Twist twist\nfloat64[36] covariance\n",
       {"geometry_msgs/Twist", kVector},
       ""},
      {kTransform,
       "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
       {kVector, kQuaternion},
       ""},
      {"sensor_msgs/PointField",
       "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
       "uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\n"
       "uint32 count\n",
       {},
       ""},
      {"sensor_msgs/NavSatStatus",
       "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 STATUS_GBAS_FIX=2\n"
       "int8 status\nuint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\n"
       "uint16 SERVICE_GALILEO=8\nuint16 service\n",
       {},
       ""},
      {"livox_ros_driver2/CustomPoint",
       "uint32 offset_time\nfloat32 x\nfloat32 y\nfloat32 z\nuint8 reflectivity\nuint8 tag\n"
       "uint8 line\n",
       {},
       ""},
      {"sensor_msgs/PointCloud2",
       "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
       "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
       {kHeader, kTime, "sensor_msgs/PointField"},
       "1158d486dd51d683ce2f1be655c3c181"},
      {"sensor_msgs/Imu",
       "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
       "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
       "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
       "float64[9] linear_acceleration_covariance\n",
       {kHeader, kTime, kQuaternion, kVector},
       "6a62c6daae103f4ff57a132d6f95cec2"},
      {"sensor_msgs/NavSatFix",
       "uint8 COVARIANCE_TYPE_UNKNOWN=0\nuint8 COVARIANCE_TYPE_APPROXIMATED=1\n"
       "uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\nuint8 COVARIANCE_TYPE_KNOWN=3\n"
       "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\n"
       "float64 longitude\nfloat64 altitude\nfloat64[9] position_covariance\n"
       "uint8 position_covariance_type\n",
       {kHeader, kTime, "sensor_msgs/NavSatStatus"},
       "2d3a8cd499b9b4a0249fb98fd05cfa48"},
      {"nav_msgs/Odometry",
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
       "geometry_msgs/TwistWithCovariance twist\n",
       {kHeader, kTime, "geometry_msgs/PoseWithCovariance", kPose, kPoint, kQuaternion,
        "geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist", kVector},
       "cd5e73d190d741a2f92e81eda573aca7"},
      {"geometry_msgs/TwistStamped",
       "std_msgs/Header header\ngeometry_msgs/Twist twist\n",
       {kHeader, kTime, "geometry_msgs/Twist", kVector},
       "98d34b0043a2093cf9d9345ab6eef12e"},
      {"geometry_msgs/TwistWithCovarianceStamped",
       "std_msgs/Header header\ngeometry_msgs/TwistWithCovariance twist\n",
       {kHeader, kTime, "geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist", kVector},
       "8927a1a12fb2607ceea095b2dc440a96"},
      {"geometry_msgs/PoseStamped",
       "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
       {kHeader, kTime, kPose, kPoint, kQuaternion},
       "d3812c3cbc69362b77dc0b19b345f8f5"},
      {"geometry_msgs/QuaternionStamped",
       "std_msgs/Header header\ngeometry_msgs/Quaternion quaternion\n",
       {kHeader, kTime, kQuaternion},
       "e57f1e547e0e1fd13504588ffc8334e2"},
      {"nmea_msgs/Sentence",
       "std_msgs/Header header\nstring sentence\n",
       {kHeader, kTime},
       "9f221efc5f4b3bac7ce4af102b32308b"},
      {kTransformStamped,
       "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
       {kHeader, kTime, kTransform, kVector, kQuaternion},
       "b5764a33bfeb3588febc2682852579b0"},
      {"tf2_msgs/TFMessage",
       "geometry_msgs/TransformStamped[] transforms\n",
       {kTransformStamped, kHeader, kTime, kTransform, kVector, kQuaternion},
       "94810edda583a504dfda3829e70d7eec"},
      {"livox_ros_driver2/CustomMsg",
       "std_msgs/Header header\nuint64 timebase\nuint32 point_num\nuint8 lidar_id\nuint8[3] rsvd\n"
       "livox_ros_driver2/CustomPoint[] points\n",
       {kHeader, kTime, "livox_ros_driver2/CustomPoint"},
       "e4d6829bdfe657cb6c21a746c86b21a6"},
      {"velodyne_msgs/VelodynePacket", "", {}, ""},  // differs: see fields_of()
      {"velodyne_msgs/VelodyneScan",
       "std_msgs/Header header\nvelodyne_msgs/VelodynePacket[] packets\n",
       {kHeader, kTime, "velodyne_msgs/VelodynePacket"},
       "50804fc9533a0e579e6322c04ae70566"},
      {"sensor_msgs/RegionOfInterest",
       "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n",
       {},
       ""},
      {"sensor_msgs/Image",
       "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
       "uint32 step\nuint8[] data\n",
       {kHeader, kTime},
       "060021388200f6f0f447d0fcd9c64743"},
      {"sensor_msgs/CompressedImage",
       "std_msgs/Header header\nstring format\nuint8[] data\n",
       {kHeader, kTime},
       "8f7a12909da2c9d3332d540a0977563f"},
      {kCameraInfo,
       "",
       {kHeader, kTime, "sensor_msgs/RegionOfInterest"},
       "c9a58c1b0b154e0e6da7578cb991d214"},  // differs: see fields_of()
  };
  return kTypes;
}

const Type* find(std::string_view name) {
  const auto found = std::ranges::find(types(), name, &Type::name);
  return found == types().end() ? nullptr : &*found;
}

std::string_view fields_of(const Type& type, Encoding encoding) {
  if (type.name == "velodyne_msgs/VelodynePacket") {
    return encoding == Encoding::ros1 ? "time stamp\nuint8[1206] data\n"
                                      : "builtin_interfaces/Time stamp\nuint8[1206] data\n";
  }
  if (type.name == kCameraInfo) {
    return encoding == Encoding::ros1
               ? "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\n"
                 "float64[] D\nfloat64[9] K\nfloat64[9] R\nfloat64[12] P\nuint32 binning_x\n"
                 "uint32 binning_y\nsensor_msgs/RegionOfInterest roi\n"
               : "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\n"
                 "float64[] d\nfloat64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\n"
                 "uint32 binning_y\nsensor_msgs/RegionOfInterest roi\n";
  }
  if (type.name != kHeader) {
    return type.fields;
  }
  return encoding == Encoding::ros1 ? "uint32 seq\ntime stamp\nstring frame_id\n"
                                    : "builtin_interfaces/Time stamp\nstring frame_id\n";
}

}  // namespace

std::optional<Definition> definition_of(std::string_view name, Encoding encoding) {
  const Type* type = find(name);
  if (type == nullptr || type->md5.empty() || encoding == Encoding::other) {
    return std::nullopt;
  }
  Definition definition{std::string(fields_of(*type, encoding)), {}};
  for (const std::string_view part : type->parts) {
    if (part == kTime && encoding == Encoding::ros1) {
      continue;  // a type of the language there
    }
    definition.text += std::string(80, '=') + "\nMSG: " + std::string(part) + "\n";
    definition.text += fields_of(*find(part), encoding);
  }
  if (encoding == Encoding::ros1) {
    definition.md5 = type->md5;
  }
  return definition;
}

}  // namespace adit::ros
