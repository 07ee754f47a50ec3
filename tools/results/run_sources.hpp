// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which sources of measurements a run used, and what each of them was worth: a table for
// summary.json, reports and pages.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace adit {

/// What a source's measurements are about.
enum class SourceEstimate {
  motion,  ///< from sweep to sweep: the sliding graph
  map,     ///< the poses of keyframes: the pose graph
};

/// A source of measurements in a run.
struct SourceWorth {
  std::string name{};   ///< "lidar", "imu", "velocity", "doppler", "odometry", "loops", "gnss", ...
  std::string topic{};  ///< empty: it has none, or several
  SourceEstimate estimate = SourceEstimate::motion;
  std::string unit{};        ///< what is counted: "sweeps", "fixes", ...
  std::size_t used = 0;      ///< measurements that count
  std::size_t refused = 0;   ///< wrong, or contradicted by the others
  std::size_t left_out = 0;  ///< of no further use, too early or too late
  std::string remark{};      ///< for people: why it was refused, or what is odd about it
  std::optional<double> innovation_squared{};  ///< mean, a degree of freedom; none: not known
  /// Share of the information about each part of the estimate; 1 over all sources of it. Empty: not
  /// known.
  std::vector<std::pair<std::string, double>> shares{};
};

/// The "sources" of summary.json.
nlohmann::ordered_json to_json(const std::vector<SourceWorth>& sources);
/// Reads them; what is not such a list has none.
std::vector<SourceWorth> sources_of(const nlohmann::ordered_json& json);

/// Two tables for people, one of the motion and one of the map; lines end with a line break. Empty
/// without sources. Lines begin with so many blanks, but for the first.
std::string describe(const std::vector<SourceWorth>& sources, std::size_t indent);

/// One line for people without its end: who decides the motion along the path, and the map. Empty
/// where lidar and IMU are the only sources.
std::string describe_shares(const std::vector<SourceWorth>& sources);

}  // namespace adit
