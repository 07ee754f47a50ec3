// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/prediction.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// Radars have up to 2 000 returns a scan; lidars that measure Doppler speeds, tens of thousands.
inline constexpr std::size_t kMostRadarReturns = 3000;

/// A scan with Doppler speeds and so few returns that no lidar measured it: of a radar.
bool is_radar_scan(const Sweep& sweep);

/// Covariance of [rho, phi] of a pose that a RadarAligner found, with what the prediction knew.
Matrix6d radar_covariance(const RegistrationResult& alignment);

/// A scan of fewer returns is not worth a place in the map.
inline constexpr int kFewestRadarReturns = 5;

/// Aligns the scans of a radar, of tens to two thousand returns each, with the last hundred of
/// them. Returns err in range and in bearing as data sheets have it, so that a return far away
/// counts little across the beam; it is compared with the Gaussians of voxels of 1 to 8 m, the
/// smallest that are several times as large as its error. The last scans are aligned together,
/// moved by what was found of their motion. On the host: a scan is three kilobytes
/// (docs/theory/radar.md, section 2). Experimental.
class RadarAligner {
 public:
  explicit RadarAligner(const PreprocessConfig& config)
      : nearest_(config.c_min), farthest_(config.c_max) {}

  /// Aligns a scan. The prediction is weighed against the matches: where these hold nothing, the
  /// pose is the prediction, and `information`, which never contains it, is zero there. `known`:
  /// the prediction is by measured velocities or inertia, so that no match need hold the pose,
  /// and the last scans can be aligned with it.
  RegistrationResult align(const Sweep& scan, const Prediction& prediction, bool known) const;

  /// The scan counts for the following ones, at this pose (T_map_lidar).
  void add(const Sweep& scan, const Eigen::Isometry3d& T_map_lidar);
  void clear();

 private:
  /// A return with the covariance of its position, lidar axes.
  struct Return {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    std::size_t level = 0;  ///< of the voxels that it is compared with
  };
  struct Scan {
    std::vector<Return> returns;
    Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  };
  using Key = std::array<int64_t, 3>;
  /// Sums over returns; positions from the voxel's corner.
  struct Voxel {
    double count = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
  };
  static constexpr std::size_t kLevels = 4;
  struct Sums;

  std::vector<Return> returns_of(const Sweep& scan) const;
  static std::vector<Return> nearest_of(std::vector<Return> returns);
  void enter(const Scan& scan, double sign);
  /// A voxel with enough returns, and what the next one in it is expected to be.
  struct Gaussian {
    const Voxel* voxel = nullptr;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
  };
  std::optional<Gaussian> gaussian_at(std::size_t level, const Eigen::Vector3d& p) const;
  Sums matches_at(const std::vector<Return>& returns, const Eigen::Isometry3d& T_map_lidar) const;

  double nearest_;           ///< m
  double farthest_;          ///< m
  std::deque<Scan> recent_;  ///< that are aligned together with the next one, oldest first
  std::deque<Scan> mapped_;  ///< in the voxels
  std::array<std::map<Key, Voxel>, kLevels> voxels_;
};

}  // namespace adit
