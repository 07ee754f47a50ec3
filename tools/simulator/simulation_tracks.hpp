// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a simulation writes message by message: each sensor with its faults and its truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/simulator/camera_simulator.hpp"
#include "adit/tools/simulator/faults.hpp"
#include "adit/tools/simulator/gnss_model.hpp"
#include "adit/tools/simulator/heading_model.hpp"
#include "adit/tools/simulator/imu_model.hpp"
#include "adit/tools/simulator/odometry_model.hpp"
#include "adit/tools/simulator/range_simulator.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/simulator/truth_writer.hpp"
#include "adit/tools/simulator/wheel_model.hpp"

namespace adit {

inline constexpr const char* kImuFrame = "imu";
inline constexpr const char* kAntennaFrame = "antenna";
inline constexpr const char* kWheelFrame = "wheels";
inline constexpr const char* kCameraFrame = "camera";

/// Puts messages into the recording, channel by channel as they come up. Times are counted from the
/// start. Throws OutputError.
class SimulationRecorder {
 public:
  explicit SimulationRecorder(const SimulationOptions& options)
      : writer_(options.output, {.compression = options.compression, .profile = "ros2"}),
        epoch_(options.epoch()) {}

  void write(const std::string& topic, Nanoseconds received, const ros::EncodedEvent& message);
  void write(const std::string& topic, Nanoseconds received, const EventValue& event,
             const char* frame);
  void close() { writer_.close(); }

 private:
  McapWriter writer_;
  Nanoseconds epoch_;
  std::map<std::string, std::size_t> channels_;
};

/// The IMU's readings and the truth. What it is given must outlive it.
class ImuTrack {
 public:
  ImuTrack(const SimulationOptions& options, const SimulationFiles& files,
           const SplineTrajectory& trajectory, const FaultMaker& faults);

  Nanoseconds time() const { return next_.sample.stamp; }  ///< time of what is written next
  void write_next(SimulationRecorder& recorder, SimulationSummary& summary);
  void close() { truth_.close(); }

 private:
  void record(SimulationRecorder& recorder, SimulationSummary& summary);

  ImuSimulator readings_;
  bool recorded_;
  Nanoseconds epoch_;
  const FaultMaker* faults_;
  TruthWriter truth_;
  SimulatedImu next_;
  uint64_t index_ = 0;
  std::vector<ImuSample> late_;
};

/// The receiver's fixes and the antenna's true way. What it is given must outlive it.
class GnssTrack {
 public:
  GnssTrack(const SimulationOptions& options, const SimulationFiles& files,
            const SplineTrajectory& trajectory, const RayScene& scene, const FaultMaker& faults);

  Nanoseconds time() const { return next_.fix.stamp; }  ///< time of what is written next
  void write_next(SimulationRecorder& recorder, SimulationSummary& summary);
  void close() { truth_.close(); }

 private:
  GnssSimulator fixes_;
  Nanoseconds epoch_;
  const FaultMaker* faults_;
  AntennaTruthWriter truth_;
  SimulatedFix next_;
  uint64_t index_ = 0;
};

/// The receiver's headings. What it is given must outlive it.
class HeadingTrack {
 public:
  HeadingTrack(const SimulationOptions& options, const SplineTrajectory& trajectory,
               const FaultMaker& faults);

  Nanoseconds time() const { return next_.stamp; }  ///< time of what is written next
  void write_next(SimulationRecorder& recorder, SimulationSummary& summary);

 private:
  HeadingSimulator headings_;
  Nanoseconds epoch_;
  const FaultMaker* faults_;
  Heading next_;
  double first_;  ///< yaw, rad
  uint64_t index_ = 0;
};

/// The wheels' velocities and the true ones. What it is given must outlive it.
class WheelTrack {
 public:
  WheelTrack(const SimulationOptions& options, const SimulationFiles& files,
             const SplineTrajectory& trajectory, const FaultMaker& faults);

  Nanoseconds time() const { return next_.received; }  ///< time of what is written next
  void write_next(SimulationRecorder& recorder, SimulationSummary& summary);
  void close() { truth_.close(); }

 private:
  WheelSimulator wheels_;
  Nanoseconds epoch_;
  const FaultMaker* faults_;
  WheelTruthWriter truth_;
  SimulatedWheels next_;
  uint64_t index_ = 0;
};

/// The poses of a visual odometry. What it is given must outlive it.
class PoseTrack {
 public:
  PoseTrack(const SimulationOptions& options, const SplineTrajectory& trajectory,
            const FaultMaker& faults);

  Nanoseconds time() const { return next_.stamp; }  ///< time of what is written next
  void write_next(SimulationRecorder& recorder, SimulationSummary& summary);

 private:
  OdometrySimulator odometry_;
  Nanoseconds epoch_;
  const FaultMaker* faults_;
  ReferencePose next_;
  uint64_t index_ = 0;
};

/// The images of a camera, each with its calibration. What it is given must outlive it.
class CameraTrack {
 public:
  CameraTrack(const SimulationOptions& options, std::size_t index, const SceneCaster& scene,
              const SplineTrajectory& trajectory, const FaultMaker& faults);

  Nanoseconds time() const { return period_ * index_; }  ///< time of what is written next
  void write_next(SimulationRecorder& recorder, SimulationSummary& summary,
                  const Checkpoint& checkpoint);

 private:
  const CameraOptions* options_;
  CameraSimulator camera_;
  Nanoseconds period_;
  Nanoseconds epoch_;
  const FaultMaker* faults_;
  int64_t index_ = 0;
};

/// A range sensor and its topic. What it is given must outlive it.
class LidarTrack {
 public:
  LidarTrack(const SimulationOptions& options, std::size_t index, const Scene& scene,
             const SplineTrajectory& trajectory, const FaultMaker& faults);

  const RangeSimulator& simulator() const { return *simulator_; }

  /// Sweep `index`, with the faults.
  RangeSweep sweep(std::size_t index, const Checkpoint& checkpoint) const;

  void write(const RangeSweep& sweep, std::size_t index, Nanoseconds received,
             SimulationRecorder& recorder, ReturnTruthWriter& truth,
             SimulationSummary& summary) const;

 private:
  const LidarOptions* options_;
  std::unique_ptr<RangeSimulator> simulator_;
  const FaultMaker* faults_;
  Nanoseconds epoch_;
  uint64_t number_;  ///< its topic's number, for faults
};

}  // namespace adit
