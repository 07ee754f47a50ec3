// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// A point of a map, m.
struct PagePoint {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();
  float intensity = 0.0F;
  uint32_t pose = 0;  ///< which of the poses saw it
};

/// A pose of a trajectory and what is shown of it; texts and NaN may be empty.
struct PagePose {
  double time = 0.0;  ///< s after the first
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  std::string state;         ///< OdometryState
  std::string registration;  ///< RegistrationStatus
  std::string imu;           ///< InertialState
  double overlap = 0.0;
  double residual_rms = 0.0;  ///< m
  double sigma = 0.0;         ///< m, the largest standard deviation of the position
};

struct MapPage {
  std::string title;
  std::string headline;   ///< one line under it
  std::string section{};  ///< what a panel at the side opens with; without it there is none
  std::string details{};  ///< what it shows then, HTML
  std::vector<PagePoint> points;
  std::vector<PagePose> poses;
};

/// A map to fly through, as one HTML page that needs nothing else, not even a network: cloud and
/// trajectory, coloured by height, intensity, time or uncertainty; a click on the trajectory tells
/// of that sweep. Nine bytes a point before base64: coordinates in 1/65535 of the map's extent. At
/// most 65535 poses are shown; more are thinned evenly.
std::string map_page(const MapPage& page);

}  // namespace adit
