// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit run --high-rate` writes: odometry_highrate.tum, and odometry_highrate.csv with
// velocities and covariances.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/fusion/high_rate_stream.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

struct HighRateOptions {
  bool enabled = false;
  double smoothing = 0.0;  ///< s
};

/// The paths of its files.
struct HighRateFiles {
  explicit HighRateFiles(const std::filesystem::path& folder)
      : tum(folder / "odometry_highrate.tum"), csv(folder / "odometry_highrate.csv") {}

  std::filesystem::path tum;
  std::filesystem::path csv;
};

/// How many poses there were, and how they lie in time.
class HighRateStatistics {
 public:
  void add(Nanoseconds stamp);

  std::size_t poses() const { return poses_; }
  std::size_t interruptions() const { return interruptions_; }  ///< gaps over 0.1 s
  /// Time of the pose that was added last.
  std::optional<Nanoseconds> last() const {
    return poses_ > 0 ? std::optional(last_) : std::nullopt;
  }
  std::optional<double> rate() const;  ///< Hz, between interruptions; none of fewer than two poses

 private:
  std::size_t poses_ = 0;
  std::size_t interruptions_ = 0;
  std::size_t intervals_ = 0;
  double span_ = 0.0;  ///< s, without interruptions
  Nanoseconds last_{0};
};

/// Writes the odometry at the rate of the inertial readings. Throws OutputError.
class HighRateOutput {
 public:
  explicit HighRateOutput(const std::filesystem::path& folder);

  void write(const LidarMotion& motion);
  void flush();  ///< what was written before it is with the operating system then
  void close();

  const HighRateStatistics& statistics() const { return statistics_; }

 private:
  TrajectoryWriter tum_;
  OutputFile csv_;
  HighRateStatistics statistics_;
};

/// The "high_rate" of summary.json, and one line for people.
nlohmann::ordered_json to_json(const HighRateStatistics& statistics);
std::string describe(const HighRateStatistics& statistics);

}  // namespace adit
