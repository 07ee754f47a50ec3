// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/simulator/ray_scene.hpp"
#include "adit/tools/simulator/spline.hpp"

namespace adit {

/// Where the world's origin lies; east, north and up are world x, y and z.
inline constexpr double kOriginLatitude = 48.0;   ///< degrees
inline constexpr double kOriginLongitude = 11.0;  ///< degrees
inline constexpr double kOriginAltitude = 500.0;  ///< m above the ellipsoid

/// A point of the world frame on WGS 84.
Geodetic geodetic_of(const Eigen::Vector3d& p_world);

struct GnssModel {
  std::string name;
  bool rtk = true;            ///< otherwise single at best
  double confidence = 1.0;    ///< the stated standard deviation is the true one divided by this
  double multipath = 0.05;    ///< probability of an outlier where half of the sky is hidden
  double correlation = 60.0;  ///< s, of the larger part of the errors
};

std::vector<std::string> gnss_names();

/// rtk, single, overconfident (rtk that states a tenth of its errors). Throws UsageError for other
/// names, with the nearest.
GnssModel gnss_named(std::string_view name);

/// A fix and what it should have been.
struct SimulatedFix {
  GnssFix fix;  ///< stamp counted from the start of the recording
  Eigen::Vector3d p_world_antenna = Eigen::Vector3d::Zero();
  double sky = 1.0;      ///< share of the sky above 15 degrees that is open
  bool outlier = false;  ///< by multipath
};

/// Where the antenna sits in the IMU's frame (m) unless something else is asked for.
Eigen::Vector3d antenna_mount();

/// A receiver whose fix depends on how much of the sky its antenna sees: fixed RTK from 70 %, float
/// from 45 %, single from 20 %, none below. Errors are the sum of a Gauss-Markov process, which has
/// nine tenths of the variance, and white noise.
class GnssSimulator {
 public:
  /// Scene and trajectory must outlive it; the antenna's place is in the IMU's frame (m).
  GnssSimulator(GnssModel model, int rate, const SplineTrajectory& trajectory,
                const Eigen::Vector3d& p_imu_antenna, const RayScene& scene, uint64_t seed);

  SimulatedFix next();

 private:
  GnssModel model_;
  int64_t period_;  ///< ns
  const SplineTrajectory* trajectory_;
  Eigen::Vector3d p_imu_antenna_;
  const RayScene* scene_;
  uint64_t seed_;
  int64_t index_ = 0;
  Eigen::Vector3d drift_;  ///< with unit variance
};

}  // namespace adit
