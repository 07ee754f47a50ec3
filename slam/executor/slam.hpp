// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The door for programs that embed adit: measurements in, placed sweeps out.
//
//   engine::Context context;
//   auto slam = make_slam(context, Config{});
//   slam->add(measurement);                   // sweeps, readings, fixes, in any order of arrival
//   while (auto result = slam->next()) {...}  // whatever has become known by now
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/frame_tree.hpp"
#include "adit/slam/executor/measurement_gate.hpp"
#include "adit/slam/executor/sensor_feed.hpp"
#include "adit/slam/fusion/high_rate_stream.hpp"
#include "adit/slam/mapping/mapper.hpp"
#include "adit/slam/odometry/odometry.hpp"

namespace adit {

/// What became of an inertial reading is known.
struct ReadingTaken {
  ImuArrival arrival = ImuArrival::appended;  ///< what became of it
  std::optional<LidarMotion>
      motion{};  ///< at its time, where high-rate odometry is wanted and known
};

/// A sweep has been placed.
struct SweepPlaced {
  Sweep sweep;                           ///< as it was added
  SweepResult result;                    ///< its pose, and how it came about
  std::optional<MapPlacement> mapped{};  ///< where there is a map
  double map_ms = 0.0;                   ///< that the odometry waited for the map
  /// When the map began and ended with it, on the host's steady clock.
  std::chrono::steady_clock::time_point map_begun{};
  std::chrono::steady_clock::time_point map_ended{};  ///< see map_begun
};

/// A sweep that has no place in a trajectory: its time is not after that of the sweep before it.
struct SweepLeftOut {
  Sweep sweep;          ///< as it was added
  Nanoseconds last{0};  ///< stamp of the sweep before it
};

/// What Slam::next() gives.
using SlamResult = std::variant<ReadingTaken, SweepPlaced, SweepLeftOut>;

/// Where the mounting of the inertial sensor on the range sensor comes from.
enum class MountingSource {
  configured,  ///< imu.T_imu_lidar
  transforms,  ///< the static transforms that were added, by the frames of the measurements
  assumed,     ///< nobody: their axes are taken to be the same
};
/// How the inertial sensor is mounted on the range sensor.
struct Mounting {
  MountingSource source = MountingSource::assumed;  ///< who told it
  Eigen::Isometry3d T_imu_lidar =
      Eigen::Isometry3d::Identity();  ///< maps lidar coordinates to the IMU
  /// Transforms that mount the sensors differently, where some do; see FrameTree.
  std::optional<MountingConflict> conflict{};
};

/// What a Slam is to do besides odometry.
struct SlamOptions {
  bool inertial = true;  ///< there is an inertial sensor: sweeps wait for its readings
  /// High-rate odometry is wanted: corrections are spread over so many seconds (0: they are steps).
  std::optional<double> high_rate_smoothing{};
  /// Where a map is kept, and whose share of it this is; null: no map is made. Outlives the Slam.
  MapStore* map = nullptr;
  SessionId session = 0;   ///< as MapStore::add_session() gave it
  MapMemory map_memory{};  ///< that the map may take
  /// What becomes of the sessions that the store had before.
  EarlierSessions earlier_sessions = EarlierSessions::none;
  /// Where the first sweep is expected in their map; else places are recognised by their looks, or
  /// GNSS fixes say it.
  std::optional<StartPlace> start{};
  /// The map may be some sweeps behind the odometry; otherwise the map holds each sweep before the
  /// next is placed, so that it has no more than next() has given.
  bool map_beside = true;
  /// Sweeps that the map may be behind the odometry before that waits. At least 1.
  std::size_t most_behind = 4;
  /// Called as soon as the odometry has placed a sweep, before the map has it; empty: not called.
  std::function<void(const Sweep&, const SweepResult&)> placed{};
};

/// The whole system: measurements in, placed sweeps out. make_slam() makes one.
class Slam {
 public:
  Slam() = default;
  virtual ~Slam() = default;
  Slam(const Slam&) = delete;
  Slam& operator=(const Slam&) = delete;

  /// Takes a measurement, in any order of arrival (SensorFeed puts them into theirs). `frame` names
  /// the sensor's frame, where static transforms are to tell the mounting. GNSS fixes tie the map
  /// to the world, and are passed over where none is made; so are velocities without an inertial
  /// sensor. Values that are not finite go no farther
  /// (MeasurementGate); faults() counts them.
  virtual void add(Measurement measurement, std::string_view frame = {}) = 0;

  /// How two frames are mounted. The mounting of the IMU is looked up for the first sweep after the
  /// first reading; while no transform gives it, each further transform is a reason to look again.
  virtual void add(const StaticTransform& transform) = 0;

  /// Nothing more comes for now: sweeps wait no longer. add() may go on after that.
  virtual void flush() = 0;

  /// The next result; nothing where that needs more measurements, or a flush(), or where a sweep is
  /// not in the map yet, so that asking again later gives it. Throws engine::Error where the device
  /// fails. Where the map fails, sweeps that were placed come first, without `mapped`; then it
  /// throws what the map's store threw, once, and nothing comes any more.
  virtual std::optional<SlamResult> next() = 0;

  /// Waits until the map has what the odometry has placed: next() gives it then.
  virtual void settle() = 0;

  /// How the sensors are mounted; nothing before the first sweep after the first reading of an
  /// inertial sensor.
  virtual std::optional<Mounting> mounting() const = 0;

  /// The configuration in force: lengths that were left at 0 are as the first sweep shows them.
  virtual const Config& config() const = 0;

  /// What was left out or mended of the measurements so far, as no sensor measures it.
  virtual MeasurementFaults faults() const { return {}; }

  /// Ends the map: its last keyframe is stored, and its final poses. No sweep may come after that.
  /// Nothing where no map is made, or where it failed and next() has thrown that.
  virtual std::optional<MapReport> finish_map() = 0;
};

/// A Slam that is driven by its measurements' own time: the same measurements give the same bytes
/// on one device. Where a map is made, a thread of its own adds a sweep to it while the odometry is
/// at the next. `config` must have passed validate(); `context` outlives it.
std::unique_ptr<Slam> make_slam(engine::Context& context, const Config& config,
                                const SlamOptions& options = {});

}  // namespace adit
