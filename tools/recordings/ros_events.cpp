// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/ros_events.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>

#include "adit/tools/packets/nmea_heading.hpp"
#include "adit/tools/recordings/ros_clouds.hpp"
#include "adit/tools/recordings/ros_images.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit::ros {
namespace {

Nanoseconds time_of(const Header& header, const RawMessage& message) {
  return header.stamp == Nanoseconds(0) ? message.received : header.stamp;
}

Eigen::Vector3d vector(const Vector3& v) {
  return {v.x, v.y, v.z};
}
Vector3 vector(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

/// Throws CodecError where the numbers are no pose.
Eigen::Isometry3d isometry(const Vector3& position, const Quaternion& rotation) {
  const Eigen::Quaterniond q(rotation.w, rotation.x, rotation.y, rotation.z);
  const double norm = q.norm();
  // A scaled quaternion still names one rotation. Far from 1, digits or the field are not its own.
  if (!(norm > 1e-3 && norm < 1e3)) {
    const std::string found =
        norm < 1e3 ? "length " + std::to_string(norm) : "a length beyond 1000, or of none";
    throw CodecError("its pose has a quaternion of " + found + " (expected: 1)");
  }
  if (!is_position(vector(position))) {
    throw CodecError("its pose has a position that is not finite, or beyond 1e12 m");
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = vector(position);
  return pose;
}

Quaternion quaternion(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return {q.x(), q.y(), q.z(), q.w()};
}

ImuSample to_event(const Imu& imu, const RawMessage& message) {
  return {.stamp = time_of(imu.header, message),
          .angular_velocity = vector(imu.angular_velocity),
          .linear_acceleration = vector(imu.linear_acceleration)};
}

GnssFix to_event(const NavSatFix& fix, const RawMessage& message) {
  GnssFix event;
  event.stamp = time_of(fix.header, message);
  event.kind = fix.status < 0    ? GnssFixKind::none
               : fix.status == 0 ? GnssFixKind::single
               : fix.status == 1 ? GnssFixKind::satellite_augmented
                                 : GnssFixKind::ground_augmented;
  event.latitude = fix.latitude;
  event.longitude = fix.longitude;
  event.altitude = fix.altitude;
  if (fix.position_covariance_type != 0) {
    event.covariance = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
        fix.position_covariance.data());
  }
  return event;
}

/// The covariance of the linear velocity; none where its numbers cannot be one. Drivers leave zeros
/// or put -1 where they do not know it.
std::optional<Eigen::Matrix3d> linear_covariance(const std::array<double, 36>& rows) {
  const Eigen::Matrix3d given =
      Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(rows.data())
          .topLeftCorner<3, 3>();
  if (!given.allFinite() || given.isZero(0.0) || given.diagonal().minCoeff() < 0.0) {
    return std::nullopt;
  }
  return given;
}

BodyVelocity velocity(const Header& header, const RawMessage& message, const Vector3& linear,
                      std::optional<Eigen::Matrix3d> covariance, const std::string& frame) {
  return {.stamp = time_of(header, message),
          .linear = vector(linear),
          .covariance = std::move(covariance),
          .frame = frame};
}

BodyVelocity to_event(const TwistStamped& twist, const RawMessage& message) {
  return velocity(twist.header, message, twist.twist.linear, std::nullopt, twist.header.frame);
}

BodyVelocity to_event(const TwistWithCovarianceStamped& twist, const RawMessage& message) {
  return velocity(twist.header, message, twist.twist.linear, linear_covariance(twist.covariance),
                  twist.header.frame);
}

// Of the length of a quaternion: numbers that drivers round, not numbers of something else.
constexpr double kMostUnlikeOne = 0.1;

/// The yaw of the x axis in the axes east, north, up. Throws CodecError where the numbers are no
/// rotation.
double heading_of(const Quaternion& q) {
  const Eigen::Vector3d axis = isometry({}, q).linear().col(0);
  return std::atan2(axis.y(), axis.x());
}

Heading to_event(const QuaternionStamped& orientation, const RawMessage& message) {
  return {.stamp = time_of(orientation.header, message),
          .yaw = heading_of(orientation.quaternion),
          .frame = orientation.header.frame};
}

/// Drivers without an orientation say so by -1 in its covariance, or leave zeros or NaN in its
/// numbers.
std::optional<Heading> heading_of(const Imu& imu, const RawMessage& message) {
  const Quaternion& q = imu.orientation;
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(std::abs(length - 1.0) < kMostUnlikeOne) || imu.orientation_covariance[0] < 0.0) {
    return std::nullopt;
  }
  const double variance = imu.orientation_covariance[8];
  return Heading{.stamp = time_of(imu.header, message),
                 .yaw = heading_of(q),
                 .sigma = variance > 0.0 ? std::optional(std::sqrt(variance)) : std::nullopt,
                 .frame = imu.header.frame};
}

ReferencePose to_event(const Odometry& odometry, const RawMessage& message) {
  return {.stamp = time_of(odometry.header, message),
          .parent = odometry.header.frame,
          .child = odometry.child_frame,
          .T_parent_child = isometry(odometry.pose.position, odometry.pose.orientation)};
}

ReferencePose to_event(const PoseStamped& pose, const RawMessage& message) {
  return {.stamp = time_of(pose.header, message),
          .parent = pose.header.frame,
          .child = {},
          .T_parent_child = isometry(pose.pose.position, pose.pose.orientation)};
}

EventValue to_event(const TransformStamped& transform, const RawMessage& message, bool is_static) {
  const Eigen::Isometry3d pose = isometry(transform.translation, transform.rotation);
  if (is_static) {
    const Quaternion& q = transform.rotation;
    return StaticTransform{transform.header.frame, transform.child_frame, pose,
                           Eigen::Quaterniond(q.w, q.x, q.y, q.z).norm()};
  }
  return ReferencePose{time_of(transform.header, message), transform.header.frame,
                       transform.child_frame, pose};
}

bool is_livox(std::string_view type) {
  return type.starts_with("livox") && type.ends_with("/CustomMsg");
}
bool is_transforms(std::string_view type) {
  return type == TFMessage::kType || type == "tf/tfMessage";
}
bool is_static(const Channel& channel) {
  return channel.topic.ends_with("tf_static");
}

/// The one event of a message that holds one.
template <class Message>
MessageEvents single(const Channel& channel, const RawMessage& message) {
  auto decoded = decode<Message>(channel.encoding, message.bytes);
  MessageEvents events;
  events.values.emplace_back(to_event(decoded, message));
  events.frame = std::move(decoded.header.frame);
  return events;
}

/// The heading of a sentence that tells one; others are of no use here.
MessageEvents sentence(const Channel& channel, const RawMessage& message) {
  const auto decoded = decode<Sentence>(channel.encoding, message.bytes);
  MessageEvents events;
  if (const std::optional<NmeaHeading> told = nmea_heading(decoded.sentence)) {
    events.values.emplace_back(Heading{.stamp = time_of(decoded.header, message),
                                       .yaw = told->yaw,
                                       .sigma = told->sigma,
                                       .frame = decoded.header.frame});
  }
  events.frame = decoded.header.frame;
  return events;
}

MessageEvents transforms(const Channel& channel, const RawMessage& message) {
  MessageEvents events;
  for (const TransformStamped& one :
       decode<TFMessage>(channel.encoding, message.bytes).transforms) {
    try {
      events.values.push_back(to_event(one, message, is_static(channel)));
    } catch (const CodecError& error) {
      events.left_out.push_back("the transform from '" + one.header.frame + "' to '" +
                                one.child_frame + "': " + error.what());
    }
  }
  return events;
}

MessageEvents sweep(CloudFile cloud, std::string frame) {
  MessageEvents events;
  events.values.emplace_back(std::move(cloud.sweep));
  events.frame = std::move(frame);
  events.point_times = std::move(cloud.times);
  events.has_intensity = cloud.has_intensity;
  events.coordinate_step = cloud.coordinate_step;
  events.faults = std::move(cloud.faults);
  return events;
}

EncodedEvent encoded(const auto& message, Encoding encoding) {
  return {std::string(message.kType), encode(encoding, message)};
}

EncodedEvent message_of(const Sweep& sweep, Encoding encoding, const std::string& frame,
                        bool with_intensity) {
  const CloudMessage cloud = to_cloud(sweep, frame, with_intensity);
  return encoded(cloud.message, encoding);
}

EncodedEvent message_of(const ImuSample& sample, Encoding encoding, const std::string& frame) {
  Imu imu;
  imu.header = {.sequence = 0, .stamp = sample.stamp, .frame = frame};
  imu.orientation_covariance[0] = -1.0;  // by the message's definition: no orientation
  imu.angular_velocity = vector(sample.angular_velocity);
  imu.linear_acceleration = vector(sample.linear_acceleration);
  return encoded(imu, encoding);
}

EncodedEvent message_of(const GnssFix& fix, Encoding encoding, const std::string& frame) {
  NavSatFix message;
  message.header = {.sequence = 0, .stamp = fix.stamp, .frame = frame};
  message.status = static_cast<int8_t>(static_cast<int>(fix.kind) - 1);
  message.latitude = fix.latitude;
  message.longitude = fix.longitude;
  message.altitude = fix.altitude;
  if (fix.covariance) {
    constexpr uint8_t kKnown = 3;
    message.position_covariance_type = kKnown;
    for (std::size_t i = 0; i < 9; ++i) {
      message.position_covariance[i] =
          (*fix.covariance)(static_cast<int>(i / 3), static_cast<int>(i % 3));
    }
  }
  return encoded(message, encoding);
}

EncodedEvent message_of(const BodyVelocity& velocity, Encoding encoding, const std::string& frame) {
  constexpr double kUnknown = 1e6;  // (rad/s)², so large that nobody takes the zeros for measured
  TwistWithCovarianceStamped message;
  message.header = {.sequence = 0,
                    .stamp = velocity.stamp,
                    .frame = velocity.frame.empty() ? frame : velocity.frame};
  message.twist.linear = vector(velocity.linear);
  if (velocity.covariance) {
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> rows(message.covariance.data());
    rows.topLeftCorner<3, 3>() = *velocity.covariance;
    rows.diagonal().tail<3>().setConstant(kUnknown);
  }
  return encoded(message, encoding);
}

EncodedEvent message_of(const Heading& heading, Encoding encoding, const std::string& frame) {
  QuaternionStamped message;
  message.header = {.sequence = 0,
                    .stamp = heading.stamp,
                    .frame = heading.frame.empty() ? frame : heading.frame};
  message.quaternion.z = std::sin(0.5 * heading.yaw);
  message.quaternion.w = std::cos(0.5 * heading.yaw);
  return encoded(message, encoding);
}

EncodedEvent message_of(const ReferencePose& pose, Encoding encoding, const std::string&) {
  Odometry message;
  message.header = {.sequence = 0, .stamp = pose.stamp, .frame = pose.parent};
  message.child_frame = pose.child;
  message.pose = {vector(pose.T_parent_child.translation()), quaternion(pose.T_parent_child)};
  return encoded(message, encoding);
}

EncodedEvent message_of(const StaticTransform& transform, Encoding encoding, const std::string&) {
  TransformStamped stamped;
  stamped.header.frame = transform.parent;
  stamped.child_frame = transform.child;
  stamped.translation = vector(transform.T_parent_child.translation());
  stamped.rotation = quaternion(transform.T_parent_child);
  return encoded(TFMessage{{stamped}}, encoding);
}

}  // namespace

TopicKind kind_of(const Channel& channel) {
  const std::string& type = channel.type;
  if (channel.encoding == Encoding::other) {
    return TopicKind::other;
  }
  if (type == PointCloud2::kType || type == VelodyneScan::kType || is_livox(type)) {
    return TopicKind::sweeps;
  }
  if (type == Imu::kType) {
    return TopicKind::imu;
  }
  if (type == NavSatFix::kType) {
    return TopicKind::gnss;
  }
  if (type == TwistStamped::kType || type == TwistWithCovarianceStamped::kType) {
    return TopicKind::velocities;
  }
  if (type == QuaternionStamped::kType || type == Sentence::kType) {
    return TopicKind::headings;
  }
  if (type == TransformStamped::kType || is_transforms(type)) {
    return is_static(channel) ? TopicKind::transforms : TopicKind::poses;
  }
  return type == Odometry::kType || type == PoseStamped::kType ? TopicKind::poses
                                                               : TopicKind::other;
}

MessageEvents to_events(const Channel& channel, const RawMessage& message,
                        const std::filesystem::path& file, const CloudReading& reading,
                        const DepthCamera* camera) {
  const std::string& type = channel.type;
  if (type == PointCloud2::kType) {
    const auto cloud = decode<PointCloud2>(channel.encoding, message.bytes);
    return sweep(to_sweep(cloud, time_of(cloud.header, message), file, reading),
                 cloud.header.frame);
  }
  if (type == VelodyneScan::kType) {
    const auto scan = decode<VelodyneScan>(channel.encoding, message.bytes);
    return sweep(to_sweep(scan, time_of(scan.header, message)), scan.header.frame);
  }
  if (is_livox(type)) {
    const auto cloud = decode<LivoxCustomMsg>(channel.encoding, message.bytes);
    return sweep(to_sweep(cloud, time_of(cloud.header, message)), cloud.header.frame);
  }
  if (type == Image::kType && camera != nullptr) {
    const auto image = decode<Image>(channel.encoding, message.bytes);
    MessageEvents events;
    events.values.emplace_back(to_sweep(image, *camera, time_of(image.header, message)));
    events.frame = image.header.frame;
    events.has_intensity = false;
    return events;
  }
  if (type == Imu::kType) {
    return single<Imu>(channel, message);
  }
  if (type == NavSatFix::kType) {
    return single<NavSatFix>(channel, message);
  }
  if (type == TwistStamped::kType) {
    return single<TwistStamped>(channel, message);
  }
  if (type == TwistWithCovarianceStamped::kType) {
    return single<TwistWithCovarianceStamped>(channel, message);
  }
  if (type == QuaternionStamped::kType) {
    return single<QuaternionStamped>(channel, message);
  }
  if (type == Sentence::kType) {
    return sentence(channel, message);
  }
  if (type == Odometry::kType) {
    return single<Odometry>(channel, message);
  }
  if (type == PoseStamped::kType) {
    return single<PoseStamped>(channel, message);
  }
  if (type == TransformStamped::kType) {
    MessageEvents events;
    events.values.push_back(to_event(decode<TransformStamped>(channel.encoding, message.bytes),
                                     message, is_static(channel)));
    return events;
  }
  return is_transforms(type) ? transforms(channel, message) : MessageEvents{};
}

MessageEvents to_velocity(const Channel& channel, const RawMessage& message) {
  const auto odometry = decode<Odometry>(channel.encoding, message.bytes);
  MessageEvents events;
  events.values.emplace_back(velocity(odometry.header, message, odometry.linear,
                                      linear_covariance(odometry.twist_covariance),
                                      odometry.child_frame));
  events.frame = odometry.child_frame;
  return events;
}

MessageEvents to_reading_and_heading(const Channel& channel, const RawMessage& message) {
  const auto imu = decode<Imu>(channel.encoding, message.bytes);
  MessageEvents events;
  events.values.emplace_back(to_event(imu, message));
  if (const std::optional<Heading> heading = heading_of(imu, message)) {
    events.values.emplace_back(*heading);
  }
  events.frame = imu.header.frame;
  return events;
}

EncodedEvent from_event(const EventValue& event, Encoding encoding, const std::string& frame,
                        bool with_intensity) {
  return std::visit(
      [&](const auto& value) {
        if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Sweep>) {
          return message_of(value, encoding, frame, with_intensity);
        } else {
          return message_of(value, encoding, frame);
        }
      },
      event);
}

}  // namespace adit::ros
