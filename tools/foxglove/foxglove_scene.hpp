// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adit/tools/foxglove/foxglove_messages.hpp"

namespace adit {

/// Lines of one colour, a pixel or more wide.
struct ShownLines {
  bool strip = true;   ///< each point is tied to the next; false: points in pairs
  double width = 2.0;  ///< pixels
  ShownColour colour{};
  std::vector<Eigen::Vector3d> points{};  ///< m
};

/// A box or an ellipsoid.
struct ShownBody {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of its middle and axes
  Eigen::Vector3d size = Eigen::Vector3d::Ones();          ///< m, whole lengths along its axes
  ShownColour colour{};
};

/// What is drawn together, and replaced together by its name.
struct ShownEntity {
  std::string id;
  std::vector<ShownLines> lines{};
  std::vector<ShownBody> boxes{};
  std::vector<ShownBody> ellipsoids{};
};

/// foxglove.SceneUpdate that shows the entity until another one of its name.
ProtobufMessage scene_update(Nanoseconds stamp, const std::string& frame,
                             const ShownEntity& entity);

/// The ellipsoid of so many standard deviations. `covariance` of the position, m^2, in the axes of
/// `pose`: symmetric; negative eigenvalues count as 0.
ShownBody uncertainty_ellipsoid(const Eigen::Isometry3d& pose, const Eigen::Matrix3d& covariance,
                                double sigmas);

}  // namespace adit
