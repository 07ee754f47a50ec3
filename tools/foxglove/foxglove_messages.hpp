// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Messages of Foxglove's schemas, as their viewers read them. Poses, points and covariances are
// those of the frame that is named; metres, and a quaternion's sign as Eigen gives it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/protobuf_message.hpp"

namespace adit {

/// Red, green, blue and opacity, 0 to 1.
struct ShownColour {
  double r = 1.0;
  double g = 1.0;
  double b = 1.0;
  double a = 1.0;
};

/// Foxglove's levels of a log, by their numbers.
enum class ShownLevel { debug = 1, info = 2, warning = 3, error = 4 };

/// A place on WGS 84 at a time.
struct ShownLocation {
  Nanoseconds stamp{0};
  std::string frame;  ///< whose origin is there; empty: of none
  Geodetic place;
  std::optional<Eigen::Matrix3d> covariance{};  ///< east north up, m^2
  std::optional<ShownColour> colour{};
  std::vector<std::pair<std::string, std::string>> metadata{};
};

ProtobufMessage protobuf_of(Nanoseconds stamp);  ///< google.protobuf.Timestamp
ProtobufMessage protobuf_of(const ShownColour& colour);
ProtobufMessage protobuf_of(const Eigen::Vector3d& vector);  ///< Vector3 and Point3
ProtobufMessage protobuf_of(const Eigen::Isometry3d& pose);

/// foxglove.FrameTransform: `pose` is T_parent_child.
ProtobufMessage frame_transform(Nanoseconds stamp, std::string_view parent, std::string_view child,
                                const Eigen::Isometry3d& pose);

/// foxglove.PoseInFrame: `pose` maps to the frame.
ProtobufMessage pose_in_frame(Nanoseconds stamp, std::string_view frame,
                              const Eigen::Isometry3d& pose);

/// foxglove.PointCloud of x, y, z and `fourth`, which is what Point::intensity holds (empty:
/// nothing that is to be shown): float32, 16 bytes a point, in the axes of the frame.
ProtobufMessage point_cloud(Nanoseconds stamp, std::string_view frame, std::string_view fourth,
                            std::span<const Point> points);

/// foxglove.LocationFix.
ProtobufMessage location_fix(const ShownLocation& location);

/// foxglove.Log.
ProtobufMessage log_message(Nanoseconds stamp, ShownLevel level, std::string_view text);

}  // namespace adit
