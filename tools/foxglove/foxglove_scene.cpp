// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/foxglove_scene.hpp"

#include <Eigen/Eigenvalues>

namespace adit {
namespace {

constexpr int64_t kLineStrip = 0;
constexpr int64_t kLineList = 2;
constexpr int kEntityCubes = 8;
constexpr int kEntitySpheres = 9;
constexpr int kEntityLines = 11;

ProtobufMessage line_primitive(const ShownLines& lines) {
  ProtobufMessage message;
  message.integer(1, lines.strip ? kLineStrip : kLineList);
  message.message(2, protobuf_of(Eigen::Isometry3d(Eigen::Isometry3d::Identity())));
  message.number(3, lines.width);
  message.integer(4, 1);  // pixels, however far it is
  for (const Eigen::Vector3d& point : lines.points) {
    message.message(5, protobuf_of(point));
  }
  message.message(6, protobuf_of(lines.colour));
  return message;
}

/// A cube or a sphere: both have the same fields.
ProtobufMessage body_primitive(const ShownBody& body) {
  ProtobufMessage message;
  message.message(1, protobuf_of(body.pose));
  message.message(2, protobuf_of(body.size));
  message.message(3, protobuf_of(body.colour));
  return message;
}

}  // namespace

ProtobufMessage scene_update(Nanoseconds stamp, const std::string& frame,
                             const ShownEntity& entity) {
  ProtobufMessage drawn;
  drawn.message(1, protobuf_of(stamp));
  drawn.text(2, frame);
  drawn.text(3, entity.id);
  drawn.message(4, protobuf_of(Nanoseconds(0)));  // for ever
  drawn.integer(5, 1);                            // moves with its frame
  for (const ShownBody& box : entity.boxes) {
    drawn.message(kEntityCubes, body_primitive(box));
  }
  for (const ShownBody& ellipsoid : entity.ellipsoids) {
    drawn.message(kEntitySpheres, body_primitive(ellipsoid));
  }
  for (const ShownLines& lines : entity.lines) {
    drawn.message(kEntityLines, line_primitive(lines));
  }
  ProtobufMessage update;
  update.message(2, drawn);
  return update;
}

ShownBody uncertainty_ellipsoid(const Eigen::Isometry3d& pose, const Eigen::Matrix3d& covariance,
                                double sigmas) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance);
  Eigen::Matrix3d rotation = axes.eigenvectors();
  if (rotation.determinant() < 0.0) {
    rotation.col(0) = -rotation.col(0);
  }
  ShownBody body{.pose = pose};
  body.pose.linear() = pose.linear() * rotation;
  body.size = 2.0 * sigmas * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return body;
}

}  // namespace adit
