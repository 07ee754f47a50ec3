// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>

#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/simulator/gnss_model.hpp"
#include "adit/tools/simulator/imu_model.hpp"
#include "adit/tools/simulator/range_simulator.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/simulator/wheel_model.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

/// Writes what a simulation knows and an estimator would like to.
class TruthWriter {
 public:
  /// `poses` gets T_world_lidar as TUM, `states` the IMU's state as CSV with a head line. Throws
  /// OutputError.
  TruthWriter(const std::filesystem::path& poses, const std::filesystem::path& states,
              const Eigen::Isometry3d& T_imu_lidar);

  void write(Nanoseconds epoch, const SimulatedImu& imu);
  void close();

 private:
  TrajectoryWriter poses_;
  OutputFile states_;
  Eigen::Isometry3d T_imu_lidar_;
};

/// Writes where the GNSS antenna really was.
class AntennaTruthWriter {
 public:
  /// CSV with a head line. Throws OutputError.
  explicit AntennaTruthWriter(const std::filesystem::path& file);

  void write(Nanoseconds epoch, const SimulatedFix& fix);
  void close() { file_.close(); }

 private:
  OutputFile file_;
};

/// Writes how fast the frame of the wheels really was.
class WheelTruthWriter {
 public:
  /// CSV with a head line. Throws OutputError.
  explicit WheelTruthWriter(const std::filesystem::path& file);

  void write(Nanoseconds epoch, const SimulatedWheels& wheels);
  void close() { file_.close(); }

 private:
  OutputFile file_;
};

/// Writes what each return is of, in the order of the recording: the points of a sweep's cloud that
/// are returns, in the order of the firings.
class ReturnTruthWriter {
 public:
  /// `surfaces` gets Return::surface, a byte each. `labels`, where something moves, a little-endian
  /// uint16: 0 for what stands still, n for moving object n - 1 of the scene. `colors`, where there
  /// are cameras, red, green and blue of Return::color. Throws OutputError.
  ReturnTruthWriter(const std::filesystem::path& surfaces,
                    const std::optional<std::filesystem::path>& labels,
                    const std::optional<std::filesystem::path>& colors);

  void write(const RangeSweep& sweep);
  void close();

 private:
  OutputFile surfaces_;
  std::optional<OutputFile> labels_;
  std::optional<OutputFile> colors_;
};

/// What stands still in a scene, and what moves where it is at first, as a binary PLY of coloured
/// triangles. Throws OutputError.
void write_scene_ply(const std::filesystem::path& file, const Scene& scene);

}  // namespace adit
