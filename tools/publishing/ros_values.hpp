// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses, covariances and clouds as ROS messages have them.
#pragma once

#include <array>
#include <span>
#include <string>

#include <Eigen/Geometry>

#include "adit/slam/core/types.hpp"
#include "adit/tools/recordings/ros_messages.hpp"

namespace adit {

ros::Vector3 ros_vector(const Eigen::Vector3d& v);
ros::Pose ros_pose(const Eigen::Isometry3d& T);
ros::Header ros_header(Nanoseconds stamp, const std::string& frame);
ros::TransformStamped ros_transform(Nanoseconds stamp, const std::string& parent,
                                    const std::string& child, const Eigen::Isometry3d& T);

/// Row by row.
std::array<double, 36> ros_covariance(const Matrix6d& covariance);

/// Covariance of position and small fixed-axis rotation in the parent's axes (ROS REP 103), from
/// that of the right perturbation [rho, phi] of T_parent_child with rotation R.
Matrix6d in_parent_axes(const Matrix6d& covariance, const Eigen::Matrix3d& R);

/// x, y, z and intensity. A view of the points.
ros::PointCloud2 ros_cloud(Nanoseconds stamp, const std::string& frame,
                           std::span<const Point> points);

}  // namespace adit
