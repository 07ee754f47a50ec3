// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a receiver's antenna really sits and how late its fixes are, by the fixes themselves
// (docs/theory/gnss.md).
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "adit/slam/gnss/odometry_track.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// What is wrong with where fixes are taken to be measured: the antenna sits so much farther along
/// the lidar's x, y and z (m), and stamps are so late (s), in this order.
using AntennaError = Eigen::Vector4d;
/// Of an AntennaError.
inline constexpr int kDelay = 3;

/// A fix, with where and how the lidar moved when it was taken.
struct AntennaSighting {
  NodeId node = 0;                                                 ///< it belongs to
  Eigen::Isometry3d T_node_lidar = Eigen::Isometry3d::Identity();  ///< at its time
  Vector6d twist = Vector6d::Zero();                               ///< as of TrackedMotion
  Eigen::Vector3d p_lidar_antenna = Eigen::Vector3d::Zero();       ///< m, as far as is known
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();               ///< measured, m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();        ///< of p_world, m^2
  double time = 0.0;  ///< s, increasing from one to the next
};

/// The antenna's place in the node's axes (m), with that error corrected.
Eigen::Vector3d p_node_antenna(const AntennaSighting& sighting, const AntennaError& error);

/// T_world_map T_map_node p_node_antenna - p_world, in m, not whitened.
struct AntennaResidual {
  Eigen::Vector3d residual;
  Eigen::Matrix<double, 3, 6> by_world;    ///< by T_world_map's tangent vector
  Eigen::Matrix<double, 3, 6> by_node;     ///< by T_map_node's
  Eigen::Matrix<double, 3, 4> by_antenna;  ///< by the AntennaError, at 0
};
AntennaResidual antenna_residual(const AntennaSighting& sighting,
                                 const Eigen::Isometry3d& T_world_map,
                                 const Eigen::Isometry3d& T_map_node);

/// One entry of an AntennaError.
struct AntennaParameter {
  double value = 0.0;        ///< m or s
  double sigma = 0.0;        ///< its standard deviation
  bool observable = false;   ///< the fixes tell it: to 0.1 m or 0.05 s, or to an eighth of it
  bool significant = false;  ///< observable, beyond four sigma, and large enough to matter
};

/// By least squares over graph and fixes together.
struct AntennaEstimate {
  AntennaError error = AntennaError::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
  std::vector<bool> agrees;  ///< each sighting, with the estimate, within kFixGate
};

/// How the receiver's errors are.
struct ReceiverNoise {
  double correlation = 60.0;  ///< s, as gnss.correlation
  bool height = true;         ///< heights count
};

/// Lever arm's error and delay that the fixes tell, together with the whole graph: its nodes and
/// T_world_map are free in it, as far as edges and verticals let them, and so is an error of the
/// receiver that changes slowly (three quarters of a fix's variance; first-order Gauss-Markov), so
/// that nothing that these could take as well is taken for the antenna's. One linear step from
/// where the graph is, which is to be at its optimum; its own fixes are left out. Outliers may be
/// among the sightings: they lose their influence (Geman-McClure, its scale brought down step by
/// step). Standard deviations grow with what is left of the fixes, and are no smaller than what
/// leaving out a fifth of the fixes changes (jackknife). None: there are too few, or the equations
/// cannot be solved.
std::optional<AntennaEstimate> estimate_antenna(const PoseGraph& graph,
                                                std::span<const AntennaSighting> sightings,
                                                const ReceiverNoise& noise);

/// Observable and significant, or not.
std::array<AntennaParameter, 4> judged(const AntennaEstimate& estimate);

}  // namespace adit
