// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A Slam with what it needs: its device and, where one is wanted, the file of its map.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "adit/slam/executor/slam.hpp"
#include "adit/slam/odometry/verdict.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/python/device.hpp"
#include "adit/tools/python/recording.hpp"

namespace adit::python {

struct SessionOptions {
  bool inertial = true;
  std::optional<double> high_rate_smoothing{};
  std::optional<std::filesystem::path> map{};
  std::string name = "Python";                       ///< of the map's session
  std::optional<std::filesystem::path> recording{};  ///< that it maps, for the map's provenance
};

/// One thread at a time is in it.
class SlamSession {
 public:
  /// Throws OutputError where a file lies in the map's place, engine::Error.
  SlamSession(SharedDevice device, const Config& config, const SessionOptions& options);

  void add(Measurement measurement, std::string_view frame);
  void add(const StaticTransform& transform);
  void flush();
  std::optional<SlamResult> next();
  std::optional<Mounting> mounting();
  Config config();
  Verdict verdict();
  std::optional<MapReport> finish_map();

 private:
  void require_open() const;

  std::mutex mutex_;
  SharedDevice device_;
  std::unique_ptr<MapDatabase> map_;
  SessionId session_ = 0;
  std::unique_ptr<Slam> slam_;
  RunAssessor assessor_;
  bool finished_ = false;
  std::optional<Mounting> mounting_;  ///< once it is
  Config config_;
};

/// The sweeps of a recording, as `adit run` places them, one after the other.
class PlacedSweeps {
 public:
  PlacedSweeps(std::shared_ptr<SlamSession> slam, RecordingFile& recording);

  /// Nothing at the end. Throws what reading and placing do.
  std::optional<SweepPlaced> next();

 private:
  std::mutex mutex_;
  std::shared_ptr<SlamSession> slam_;
  std::shared_ptr<RecordedEvents> events_;
  std::optional<std::size_t> imu_;  ///< topic of the readings that are used
  bool ended_ = false;
};

}  // namespace adit::python
