// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// From a scene, sensors and a motion to a recording with its truth beside it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/simulator/camera_options.hpp"
#include "adit/tools/simulator/crossings.hpp"
#include "adit/tools/simulator/gnss_model.hpp"
#include "adit/tools/simulator/heading_model.hpp"
#include "adit/tools/simulator/odometry_model.hpp"
#include "adit/tools/simulator/range_simulator.hpp"
#include "adit/tools/simulator/scene_change.hpp"
#include "adit/tools/simulator/scene_heap.hpp"
#include "adit/tools/simulator/wheel_model.hpp"

namespace adit {

/// Recordings start at this time (ns since 1970).
inline constexpr Nanoseconds kSimulationEpoch{1700000000000000000};

/// Goes up whenever the same options give other bytes, so that kept recordings are known to be old.
inline constexpr int kSimulatorRevision = 1;

/// How a range sensor is mounted unless something else is asked for: T_imu_lidar.
Eigen::Isometry3d lidar_mount();

struct LidarOptions {
  std::string sensor = "VLP-16";
  std::string topic = "/points";
  std::string frame = "lidar";
  Eigen::Isometry3d T_imu_lidar = lidar_mount();
  RangeEffects effects{};
  double begin = 0.0;                                    ///< s, it sends nothing before
  double end = std::numeric_limits<double>::infinity();  ///< s, nor after: it was unplugged
  bool doppler = false;                 ///< measures the radial speed of each return
  std::optional<CloudLayout> layout{};  ///< instead of that of the sensor's driver
};

struct SimulationOptions {
  std::string scene = "mine";
  std::vector<LidarOptions> lidars{LidarOptions{}};  ///< the truth is that of the first
  std::string trajectory = "drive";
  std::string imu = "industrial";  ///< "none": no IMU
  int imu_rate = 200;              ///< Hz
  std::string gnss = "none";       ///< "none": no receiver
  int gnss_rate = 5;               ///< Hz
  Eigen::Vector3d p_imu_antenna = antenna_mount();
  bool heading = false;  ///< of the receiver, by two antennas, on /heading
  HeadingErrors heading_errors{};
  bool wheels = false;  ///< of a vehicle, on /wheels
  int wheel_rate = 50;  ///< Hz
  Eigen::Isometry3d T_imu_wheels = wheel_mount();
  bool visual_odometry = false;   ///< of one camera, on /visual_odometry
  int visual_odometry_rate = 20;  ///< Hz
  Eigen::Isometry3d T_imu_camera = camera_mount();
  std::vector<CameraOptions> cameras{};
  std::vector<std::string> faults{};
  double duration = 60.0;       ///< s
  std::optional<double> speed;  ///< m/s, instead of the scene's
  double begin = 0.0;           ///< m along the scene's route, where the motion begins
  /// Corners on the floor (m, world) of a closed way to take instead of the scene's; empty: that.
  std::vector<Eigen::Vector3d> waypoints{};
  std::optional<double> corner_radius;  ///< m, of its rounding, instead of the scene's
  uint64_t seed = 1;
  std::optional<uint64_t> noise_seed{};  ///< of the sensors' errors; none: `seed`
  double later = 0.0;  ///< s after kSimulationEpoch that it begins: what moves has gone on
  /// Of the scene's movable objects: some are gone, elsewhere, or more than without it.
  ChangeOptions change{};
  std::vector<HeapOptions> heaps{};  ///< of loose material, besides what the scene has
  bool reverse = false;              ///< the way is taken from its end to its beginning
  bool picture = true;               ///< draw the scene and a sweep in it
  Compression compression = Compression::none;
  std::filesystem::path output;  ///< the MCAP file

  uint64_t seed_of_noise() const { return noise_seed.value_or(seed); }
  Nanoseconds epoch() const { return kSimulationEpoch + nanoseconds(later); }
};

/// Where things are, all beside the recording.
struct SimulationFiles {
  explicit SimulationFiles(const std::filesystem::path& recording);

  std::filesystem::path recording;
  std::filesystem::path trajectory;  ///< NAME.truth.tum: T_world_lidar at the IMU's rate
  std::filesystem::path states;      ///< NAME.truth.csv: pose, velocity and biases of the IMU
  std::filesystem::path antenna;     ///< NAME.truth.antenna.csv, where there is GNSS
  std::filesystem::path wheels;      ///< NAME.truth.wheels.csv, where there are wheels
  std::filesystem::path loops;       ///< NAME.truth.loops.csv: places that see the same
  std::filesystem::path labels;      ///< NAME.truth.labels, where something moves
  std::filesystem::path surfaces;    ///< NAME.truth.surfaces: what each return is of
  std::filesystem::path colors;      ///< NAME.truth.colors: of each return, where there are cameras
  std::filesystem::path changes;     ///< NAME.truth.changes.json, where objects have changed
  std::filesystem::path scene;       ///< NAME.scene.ply
  std::filesystem::path picture;     ///< NAME.scene.png
  std::filesystem::path sweep;       ///< NAME.sweep.png: a sweep in the scene
};

struct SimulationSummary {
  std::size_t triangles = 0;
  std::size_t sweeps = 0;
  std::size_t points = 0;  ///< returns
  std::size_t pulses = 0;
  std::size_t imu_samples = 0;
  std::size_t gnss_fixes = 0;
  std::size_t headings = 0;
  std::size_t wheel_velocities = 0;
  std::size_t images = 0;             ///< of all cameras
  std::size_t odometry_poses = 0;     ///< of the visual odometry
  std::size_t changes = 0;            ///< objects removed or added, a moved one twice
  double path = 0.0;                  ///< m
  double fastest_turn = 0.0;          ///< rad/s
  std::vector<Crossing> crossings{};  ///< where the first range sensor crosses what stands still
};

/// Simulates and writes. The same options give the same bytes on any machine, where the compressor
/// is the same. Throws UsageError for names that do not exist and numbers that make no sense,
/// OutputError, and what the checkpoint throws: that leaves the files unfinished.
SimulationSummary simulate(const SimulationOptions& options,
                           const std::function<void(std::size_t done, std::size_t total)>& progress,
                           const Checkpoint& checkpoint = {});

}  // namespace adit
