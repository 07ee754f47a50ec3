// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run tells of its sensors of velocities.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/core/config.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/tools/report/share_statistics.hpp"
#include "adit/tools/results/run_sources.hpp"

namespace adit {

/// What is wrong with a sensor whose velocities are not the body's, a clause for people.
std::string describe(const VelocityComparison& comparison);

/// Adds up sweeps.
class VelocityFusionStatistics {
 public:
  void add(const SweepResult& result);

  bool any() const;

  /// The "velocity" of summary.json.
  nlohmann::ordered_json to_json() const;
  /// Those that measured something, by the names "velocity" and "doppler".
  std::vector<SourceWorth> sources(const Config& config, const ShareStatistics& shares) const;
  /// A line for people for each source, without their ends.
  std::vector<std::string> text() const;

 private:
  struct Source {
    std::size_t sweeps = 0;   ///< whose way from the sweep before it was measured
    std::size_t fused = 0;    ///< of them
    std::size_t refused = 0;  ///< likewise; the others were on trial
    std::size_t slips = 0;    ///< fused, with an error that lasts
    double nis = 0.0;         ///< sum over those that were fused
    std::optional<VelocityComparison> contradiction{};  ///< the last of a refused way
  };
  /// For people: what is odd about a source, or why it was refused; empty: nothing.
  std::string remark(VelocitySource which) const;
  const Source& source(VelocitySource which) const {
    return sources_[static_cast<std::size_t>(which)];
  }

  std::array<Source, kVelocitySources> sources_{};
  VelocityCalibration calibration_{};
  Eigen::Vector3d calibration_sigma_ = Eigen::Vector3d::Zero();  ///< scale, turn
  std::size_t moving_points_ = 0;
};

}  // namespace adit
