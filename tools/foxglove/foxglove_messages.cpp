// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/foxglove_messages.hpp"

namespace adit {
namespace {

constexpr int64_t kFloat32 = 7;
constexpr int64_t kCovarianceUnknown = 0;
constexpr int64_t kCovarianceKnown = 3;

ProtobufMessage quaternion_of(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  ProtobufMessage message;
  message.number(1, q.x());
  message.number(2, q.y());
  message.number(3, q.z());
  message.number(4, q.w());
  return message;
}

}  // namespace

ProtobufMessage protobuf_of(Nanoseconds stamp) {
  const auto whole = std::chrono::floor<std::chrono::seconds>(stamp);
  ProtobufMessage message;
  message.integer(1, whole.count());
  message.integer(2, (stamp - whole).count());
  return message;
}

ProtobufMessage protobuf_of(const ShownColour& colour) {
  ProtobufMessage message;
  message.number(1, colour.r);
  message.number(2, colour.g);
  message.number(3, colour.b);
  message.number(4, colour.a);
  return message;
}

ProtobufMessage protobuf_of(const Eigen::Vector3d& vector) {
  ProtobufMessage message;
  message.number(1, vector.x());
  message.number(2, vector.y());
  message.number(3, vector.z());
  return message;
}

ProtobufMessage protobuf_of(const Eigen::Isometry3d& pose) {
  ProtobufMessage message;
  message.message(1, protobuf_of(Eigen::Vector3d(pose.translation())));
  message.message(2, quaternion_of(pose));
  return message;
}

ProtobufMessage frame_transform(Nanoseconds stamp, std::string_view parent, std::string_view child,
                                const Eigen::Isometry3d& pose) {
  ProtobufMessage message;
  message.message(1, protobuf_of(stamp));
  message.text(2, parent);
  message.text(3, child);
  message.message(4, protobuf_of(Eigen::Vector3d(pose.translation())));
  message.message(5, quaternion_of(pose));
  return message;
}

ProtobufMessage pose_in_frame(Nanoseconds stamp, std::string_view frame,
                              const Eigen::Isometry3d& pose) {
  ProtobufMessage message;
  message.message(1, protobuf_of(stamp));
  message.text(2, frame);
  message.message(3, protobuf_of(pose));
  return message;
}

ProtobufMessage point_cloud(Nanoseconds stamp, std::string_view frame, std::string_view fourth,
                            std::span<const Point> points) {
  ProtobufMessage message;
  message.message(1, protobuf_of(stamp));
  message.text(2, frame);
  message.message(3, protobuf_of(Eigen::Isometry3d(Eigen::Isometry3d::Identity())));
  message.fixed(4, sizeof(Point));
  const std::array<std::string_view, 4> names = {"x", "y", "z", fourth};
  for (std::size_t i = 0; i < (fourth.empty() ? 3U : 4U); ++i) {
    ProtobufMessage field;
    field.text(1, names[i]);
    field.fixed(2, static_cast<uint32_t>(i * sizeof(float)));
    field.integer(3, kFloat32);
    message.message(5, field);
  }
  message.bytes(6, std::as_bytes(points));
  return message;
}

ProtobufMessage location_fix(const ShownLocation& location) {
  ProtobufMessage message;
  message.message(6, protobuf_of(location.stamp));
  message.text(7, location.frame);
  message.number(1, location.place.latitude);
  message.number(2, location.place.longitude);
  message.number(3, location.place.altitude);
  const Eigen::Matrix3d covariance =
      location.covariance.value_or(Eigen::Matrix3d(Eigen::Matrix3d::Zero()));
  message.numbers(4, std::span(covariance.data(), 9));  // symmetric: rows are columns
  message.integer(5, location.covariance ? kCovarianceKnown : kCovarianceUnknown);
  if (location.colour) {
    message.message(8, protobuf_of(*location.colour));
  }
  for (const auto& [key, value] : location.metadata) {
    ProtobufMessage pair;
    pair.text(1, key);
    pair.text(2, value);
    message.message(9, pair);
  }
  return message;
}

ProtobufMessage log_message(Nanoseconds stamp, ShownLevel level, std::string_view text) {
  ProtobufMessage message;
  message.message(1, protobuf_of(stamp));
  message.integer(2, static_cast<int64_t>(level));
  message.text(3, text);
  message.text(4, "adit");
  return message;
}

}  // namespace adit
