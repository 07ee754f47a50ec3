// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace adit {

/// How an estimate is moved onto the truth before it is compared.
enum class Alignment {
  none,
  origin,  ///< the first poses are made equal
  se3,     ///< least squares over all positions (Umeyama 1991), rotation and translation
  sim3,    ///< and scale
};
std::string_view to_string(Alignment alignment);

/// x -> scale * rotation * x + translation.
struct Similarity {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< m
  double scale = 1.0;

  Eigen::Isometry3d operator*(const Eigen::Isometry3d& pose) const;
};

/// The similarity that takes `from` to `to` with the least sum of squared distances (Umeyama 1991).
/// Empty where the positions do not determine it: fewer than three, all in one place, or all on one
/// line.
std::optional<Similarity> umeyama(std::span<const Eigen::Vector3d> from,
                                  std::span<const Eigen::Vector3d> to, bool with_scale);

/// The motion that takes the estimate onto the truth. Both hold the same number of poses, at least
/// one. Empty where it is not determined.
std::optional<Similarity> align(std::span<const Eigen::Isometry3d> estimate,
                                std::span<const Eigen::Isometry3d> truth, Alignment alignment);

}  // namespace adit
