// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/simulator/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <system_error>
#include <utility>

#include "tools/recordings/mcap_writer.hpp"
#include "tools/recordings/ros_definitions.hpp"
#include "tools/recordings/ros_events.hpp"
#include "tools/simulator/cloud_messages.hpp"
#include "tools/simulator/faults.hpp"
#include "tools/simulator/gnss_model.hpp"
#include "tools/simulator/imu_model.hpp"
#include "tools/simulator/motion.hpp"
#include "tools/simulator/scene_picture.hpp"
#include "tools/simulator/sweep_picture.hpp"
#include "tools/simulator/truth_writer.hpp"
#include "tools/usage_error.hpp"

namespace adit {
namespace {

constexpr const char* kImuFrame = "imu";
constexpr const char* kLidarFrame = "lidar";
constexpr const char* kAntennaFrame = "antenna";

void check(const SimulationOptions& options) {
  if (!(options.duration >= 0.2 && options.duration <= 36000.0)) {
    throw UsageError("--duration: is " + std::to_string(options.duration) +
                     " s; must be 0.2 to 36000.");
  }
  if (options.imu_rate < 10 || options.imu_rate > 2000 || 1000000000 % options.imu_rate != 0) {
    throw UsageError("--imu-rate: is " + std::to_string(options.imu_rate) +
                     " Hz; must be a divisor of 1e9 from 10 to 2000, such as 100, 200, 400, 1000.");
  }
  if (options.gnss_rate < 1 || options.gnss_rate > 20 || 1000000000 % options.gnss_rate != 0) {
    throw UsageError("--gnss-rate: is " + std::to_string(options.gnss_rate) +
                     " Hz; must be a divisor of 1e9 from 1 to 20, such as 1, 5, 10.");
  }
  if (options.speed && !(*options.speed > 0.0 && *options.speed <= 50.0)) {
    throw UsageError("--speed: must be more than 0 and at most 50 m/s.");
  }
  if (!(options.begin >= 0.0 && options.begin <= 1e5)) {
    throw UsageError("--begin: must be 0 to 100000 m.");
  }
  if (options.output.extension() != ".mcap") {
    throw UsageError(
        "-o: the recording is written as MCAP; name it NAME.mcap. `adit convert` "
        "makes other formats of it.");
  }
}

/// Puts messages into the recording, channel by channel as they come up.
class Recorder {
 public:
  Recorder(const std::filesystem::path& path, Compression compression)
      : writer_(path, {.compression = compression, .profile = "ros2"}) {}

  void write(const std::string& topic, Nanoseconds received, const ros::EncodedEvent& message) {
    const auto [known, is_new] = channels_.try_emplace(topic, 0);
    if (is_new) {
      const auto definition = ros::definition_of(message.type, Encoding::cdr);
      known->second = writer_.add_channel({.topic = topic,
                                           .type = message.type,
                                           .encoding = Encoding::cdr,
                                           .definition = definition ? definition->text : "",
                                           .messages = std::nullopt});
    }
    writer_.write(known->second, kSimulationEpoch + received, message.bytes);
  }

  void write(const std::string& topic, Nanoseconds received, const EventValue& event,
             const char* frame) {
    write(topic, received, ros::from_event(event, Encoding::cdr, frame));
  }

  void close() { writer_.close(); }

 private:
  McapWriter writer_;
  std::map<std::string, std::size_t> channels_;
};

/// What a message of each topic is told apart by, for faults.
enum TopicNumber : uint64_t { kPoints, kImu, kGnss };

/// The IMU's readings and the truth, up to a time.
class ImuTrack {
 public:
  ImuTrack(const SimulationOptions& options, const SimulationFiles& files,
           const SplineTrajectory& trajectory, const FaultMaker& faults)
      : readings_(imu_named(options.imu == "none" ? "perfect" : options.imu), options.imu_rate,
                  trajectory, options.seed),
        recorded_(options.imu != "none"),
        faults_(&faults),
        truth_(files.trajectory, files.states, lidar_mount()),
        next_(readings_.next()) {}

  Nanoseconds time() const { return next_.sample.stamp; }

  void write_next(Recorder& recorder, SimulationSummary& summary) {
    truth_.write(kSimulationEpoch, next_);
    if (recorded_) {
      record(recorder, summary);
    }
    const Eigen::Vector3d at = next_.truth.T_world_body.translation();
    summary.fastest_turn = std::max(summary.fastest_turn, next_.truth.angular_velocity.norm());
    next_ = readings_.next();
    summary.path += (next_.truth.T_world_body.translation() - at).norm();
  }

  void close() { truth_.close(); }

 private:
  void record(Recorder& recorder, SimulationSummary& summary) {
    const Nanoseconds received = time();
    const int copies = faults_->copies(kImu, index_, received);
    ImuSample sample = next_.sample;
    faults_->distort(sample);
    sample.stamp += kSimulationEpoch;
    const bool late = faults_->comes_late(index_++);
    std::vector<ImuSample> due(static_cast<std::size_t>(copies), sample);
    if (late) {
      std::swap(due, late_);
    } else {
      due.insert(due.end(), late_.begin(), late_.end());
      late_.clear();
    }
    for (const ImuSample& one : due) {
      recorder.write("/imu", received, one, kImuFrame);
      ++summary.imu_samples;
    }
  }

  ImuSimulator readings_;
  bool recorded_;
  const FaultMaker* faults_;
  TruthWriter truth_;
  SimulatedImu next_;
  uint64_t index_ = 0;
  std::vector<ImuSample> late_;
};

/// The receiver's fixes and the antenna's true way.
class GnssTrack {
 public:
  GnssTrack(const SimulationOptions& options, const SimulationFiles& files,
            const SplineTrajectory& trajectory, const RayScene& scene, const FaultMaker& faults)
      : fixes_(gnss_named(options.gnss), options.gnss_rate, trajectory, scene, options.seed),
        faults_(&faults),
        truth_(files.antenna),
        next_(fixes_.next()) {}

  Nanoseconds time() const { return next_.fix.stamp; }

  void write_next(Recorder& recorder, SimulationSummary& summary) {
    truth_.write(kSimulationEpoch, next_);
    GnssFix fix = next_.fix;
    fix.stamp += kSimulationEpoch;
    for (int i = faults_->copies(kGnss, index_++, time()); i > 0; --i) {
      recorder.write("/gnss", time(), fix, kAntennaFrame);
      ++summary.gnss_fixes;
    }
    next_ = fixes_.next();
  }

  void close() { truth_.close(); }

 private:
  GnssSimulator fixes_;
  const FaultMaker* faults_;
  AntennaTruthWriter truth_;
  SimulatedFix next_;
  uint64_t index_ = 0;
};

/// Keeps the first four fifths of a file, as a recorder that was killed.
void cut_off(const std::filesystem::path& file) {
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (!error) {
    std::filesystem::resize_file(file, size / 5 * 4, error);
  }
  if (error) {
    throw OutputError(file, file.string() + ": cannot be cut off: " + error.message());
  }
}

void write_mounts(const SimulationOptions& options, Recorder& recorder) {
  recorder.write("/tf_static", Nanoseconds(0),
                 StaticTransform{kImuFrame, kLidarFrame, lidar_mount()}, kImuFrame);
  if (options.gnss != "none") {
    Eigen::Isometry3d T_imu_antenna = Eigen::Isometry3d::Identity();
    T_imu_antenna.translation() = antenna_mount();
    recorder.write("/tf_static", Nanoseconds(0),
                   StaticTransform{kImuFrame, kAntennaFrame, T_imu_antenna}, kImuFrame);
  }
}

std::filesystem::path beside(const std::filesystem::path& recording, const char* ending) {
  return recording.parent_path() / (recording.stem().string() + ending);
}

}  // namespace

SimulationFiles::SimulationFiles(const std::filesystem::path& file)
    : recording(file),
      trajectory(beside(file, ".truth.tum")),
      states(beside(file, ".truth.csv")),
      antenna(beside(file, ".truth.antenna.csv")),
      labels(beside(file, ".truth.labels")),
      scene(beside(file, ".scene.ply")),
      picture(beside(file, ".scene.png")),
      sweep(beside(file, ".sweep.png")) {}

Eigen::Isometry3d lidar_mount() {
  Eigen::Isometry3d T_imu_lidar = Eigen::Isometry3d::Identity();
  T_imu_lidar.translation() = Eigen::Vector3d(0.03, -0.01, 0.08);
  return T_imu_lidar;
}

SimulationSummary simulate(
    const SimulationOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  check(options);
  const Scene scene = make_scene(options.scene, options.seed);
  const SplineTrajectory trajectory =
      make_trajectory(scene, motion_named(options.trajectory), options.duration + 0.5,
                      options.speed, options.begin);
  const RangeSimulator lidar(scene, range_sensor_named(options.sensor),
                             {.trajectory = &trajectory, .T_body_lidar = lidar_mount()},
                             options.seed, options.effects);
  std::vector<Fault> faults;
  for (const std::string& name : options.faults) {
    faults.push_back(fault_named(name));
  }
  const FaultMaker fault_maker(faults, options.duration, options.seed);
  const SimulationFiles files(options.output);
  SimulationSummary summary;
  summary.triangles = scene.mesh.triangles.size();
  ImuTrack imu(options, files, trajectory, fault_maker);
  std::optional<GnssTrack> gnss;
  if (options.gnss != "none") {
    gnss.emplace(options, files, trajectory, lidar.still(), fault_maker);
  }
  std::optional<OutputFile> labels;
  if (!scene.moving.empty()) {
    labels.emplace(files.labels);
  }
  Recorder recorder(options.output, options.compression);
  write_mounts(options, recorder);
  const auto total = static_cast<std::size_t>(
      std::floor(options.duration * 1e9 / static_cast<double>(lidar.sensor().period) + 1e-6));
  for (std::size_t i = 0; i < total; ++i) {
    RangeSweep sweep = lidar.sweep(static_cast<int64_t>(i));
    fault_maker.distort(sweep);
    const Nanoseconds end(sweep.start + lidar.sensor().period);
    while (imu.time() < end || (gnss && gnss->time() < end)) {
      if (gnss && gnss->time() < imu.time()) {
        gnss->write_next(recorder, summary);
      } else {
        imu.write_next(recorder, summary);
      }
    }
    const ros::EncodedEvent message = cloud_message(
        sweep, options.layout.value_or(lidar.sensor().layout), kSimulationEpoch, kLidarFrame);
    for (int copy = fault_maker.copies(kPoints, i, end); copy > 0; --copy) {
      recorder.write("/points", end, message);
      ++summary.sweeps;
      summary.pulses += sweep.returns.size();
      summary.points += static_cast<std::size_t>(std::ranges::count_if(
          sweep.returns, [](const Return& back) { return back.range > 0.0; }));
      if (labels) {
        write_labels(*labels, sweep);
      }
    }
    if (progress) {
      progress(i + 1, total);
    }
  }
  recorder.close();
  if (fault_maker.has(Fault::truncated)) {
    cut_off(files.recording);
  }
  imu.close();
  if (gnss) {
    gnss->close();
  }
  if (labels) {
    labels->close();
  }
  write_scene_ply(files.scene, scene);
  if (options.picture) {
    write_scene_picture(files.picture, scene, lidar.still(), trajectory);
    write_sweep_picture(files.sweep, scene, lidar, static_cast<int64_t>(total / 3));
  }
  return summary;
}

}  // namespace adit
