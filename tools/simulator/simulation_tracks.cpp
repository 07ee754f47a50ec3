// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/simulation_tracks.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "adit/tools/containers/ros_definitions.hpp"
#include "adit/tools/simulator/camera_messages.hpp"
#include "adit/tools/simulator/cloud_messages.hpp"

namespace adit {
namespace {

/// What a message of each topic is told apart by, for faults. Further range sensors count on from
/// the last one, from 1.
enum TopicNumber : uint64_t {
  kPoints,
  kImu,
  kGnss,
  kWheels,
  kFurtherPoints = kWheels,
  kPoses = 13,
  kHeadings = 14,
  kImages = 15
};

/// Each range sensor has noise of its own.
uint64_t seed_of(uint64_t seed, std::size_t index) {
  return seed + 0x9e3779b97f4a7c15U * index;
}

/// The sensor with what is asked of it.
RangeSensor sensor_of(const LidarOptions& options) {
  RangeSensor sensor = range_sensor_named(options.sensor);
  sensor.doppler = options.doppler;
  return sensor;
}

}  // namespace

void SimulationRecorder::write(const std::string& topic, Nanoseconds received,
                               const ros::EncodedEvent& message) {
  const auto [known, is_new] = channels_.try_emplace(topic, 0);
  if (is_new) {
    const auto definition = ros::definition_of(message.type, Encoding::cdr);
    known->second = writer_.add_channel({.topic = topic,
                                         .type = message.type,
                                         .encoding = Encoding::cdr,
                                         .definition = definition ? definition->text : "",
                                         .messages = std::nullopt});
  }
  writer_.write(known->second, epoch_ + received, message.bytes);
}

void SimulationRecorder::write(const std::string& topic, Nanoseconds received,
                               const EventValue& event, const char* frame) {
  write(topic, received, ros::from_event(event, Encoding::cdr, frame));
}

ImuTrack::ImuTrack(const SimulationOptions& options, const SimulationFiles& files,
                   const SplineTrajectory& trajectory, const FaultMaker& faults)
    : readings_(imu_named(options.imu == "none" ? "perfect" : options.imu), options.imu_rate,
                trajectory, options.seed_of_noise()),
      recorded_(options.imu != "none"),
      epoch_(options.epoch()),
      faults_(&faults),
      truth_(files.trajectory, files.states, options.lidars.front().T_imu_lidar),
      next_(readings_.next()) {}

void ImuTrack::write_next(SimulationRecorder& recorder, SimulationSummary& summary) {
  truth_.write(epoch_, next_);
  if (recorded_) {
    record(recorder, summary);
  }
  const Eigen::Vector3d at = next_.truth.T_world_body.translation();
  summary.fastest_turn = std::max(summary.fastest_turn, next_.truth.angular_velocity.norm());
  next_ = readings_.next();
  summary.path += (next_.truth.T_world_body.translation() - at).norm();
}

void ImuTrack::record(SimulationRecorder& recorder, SimulationSummary& summary) {
  const Nanoseconds received = time();
  const int copies = faults_->is_silent(received) ? 0 : faults_->copies(kImu, index_, received);
  ImuSample sample = next_.sample;
  faults_->distort(sample);
  sample.stamp += epoch_;
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

GnssTrack::GnssTrack(const SimulationOptions& options, const SimulationFiles& files,
                     const SplineTrajectory& trajectory, const RayScene& scene,
                     const FaultMaker& faults)
    : fixes_(gnss_named(options.gnss), options.gnss_rate, trajectory, options.p_imu_antenna, scene,
             options.seed_of_noise()),
      epoch_(options.epoch()),
      faults_(&faults),
      truth_(files.antenna),
      next_(fixes_.next()) {}

void GnssTrack::write_next(SimulationRecorder& recorder, SimulationSummary& summary) {
  truth_.write(epoch_, next_);
  GnssFix fix = next_.fix;
  fix.stamp += epoch_;
  for (int i = faults_->copies(kGnss, index_++, time()); i > 0; --i) {
    recorder.write("/gnss", time(), fix, kAntennaFrame);
    ++summary.gnss_fixes;
  }
  next_ = fixes_.next();
}

HeadingTrack::HeadingTrack(const SimulationOptions& options, const SplineTrajectory& trajectory,
                           const FaultMaker& faults)
    : headings_(options.heading_errors, options.gnss_rate, trajectory, options.p_imu_antenna,
                options.seed_of_noise()),
      epoch_(options.epoch()),
      faults_(&faults),
      next_(headings_.next()),
      first_(next_.yaw) {}

void HeadingTrack::write_next(SimulationRecorder& recorder, SimulationSummary& summary) {
  Heading heading = next_;
  faults_->distort(heading, first_);
  heading.stamp += epoch_;
  for (int i = faults_->copies(kHeadings, index_++, time()); i > 0; --i) {
    recorder.write("/heading", time(), heading, kAntennaFrame);
    ++summary.headings;
  }
  next_ = headings_.next();
}

WheelTrack::WheelTrack(const SimulationOptions& options, const SimulationFiles& files,
                       const SplineTrajectory& trajectory, const FaultMaker& faults)
    : wheels_(options.wheel_rate, trajectory, options.T_imu_wheels, options.seed_of_noise()),
      epoch_(options.epoch()),
      faults_(&faults),
      truth_(files.wheels),
      next_(wheels_.next()) {}

void WheelTrack::write_next(SimulationRecorder& recorder, SimulationSummary& summary) {
  truth_.write(epoch_, next_);
  BodyVelocity velocity = next_.velocity;
  faults_->distort(velocity);
  velocity.stamp += epoch_;
  for (int i = faults_->copies(kWheels, index_++, time()); i > 0; --i) {
    recorder.write("/wheels", time(), velocity, kWheelFrame);
    ++summary.wheel_velocities;
  }
  next_ = wheels_.next();
}

PoseTrack::PoseTrack(const SimulationOptions& options, const SplineTrajectory& trajectory,
                     const FaultMaker& faults)
    : odometry_(options.visual_odometry_rate, trajectory, options.T_imu_camera,
                options.seed_of_noise()),
      epoch_(options.epoch()),
      faults_(&faults),
      next_(odometry_.next()) {}

void PoseTrack::write_next(SimulationRecorder& recorder, SimulationSummary& summary) {
  ReferencePose pose = next_;
  faults_->distort(pose);
  pose.stamp += epoch_;
  for (int i = faults_->copies(kPoses, index_++, time()); i > 0; --i) {
    recorder.write("/visual_odometry", time(), pose, kCameraFrame);
    ++summary.odometry_poses;
  }
  next_ = odometry_.next();
}

CameraTrack::CameraTrack(const SimulationOptions& options, std::size_t index,
                         const SceneCaster& scene, const SplineTrajectory& trajectory,
                         const FaultMaker& faults)
    : options_(&options.cameras[index]),
      camera_(scene, camera_lens(options_->lens),
              {.trajectory = &trajectory, .T_body_camera = options_->T_imu_camera}, options.seed),
      period_(std::chrono::nanoseconds(std::chrono::seconds(1)) / options_->rate),
      epoch_(options.epoch()),
      faults_(&faults) {}

void CameraTrack::write_next(SimulationRecorder& recorder, SimulationSummary& summary,
                             const Checkpoint& checkpoint) {
  const int copies = faults_->copies(kImages, static_cast<uint64_t>(index_), time());
  if (copies > 0) {
    SimulatedImage image{.stamp = time(), .image = camera_.image(seconds(time()), checkpoint)};
    faults_->distort(image);
    image.stamp += epoch_;
    const std::string frame = options_->frame();
    for (int i = 0; i < copies; ++i) {
      recorder.write(options_->topic("image_raw"), time(), image_message(image, frame));
      recorder.write(options_->topic("camera_info"), time(),
                     camera_info_message(camera_.camera(), image.stamp, frame));
      ++summary.images;
    }
  }
  ++index_;
}

LidarTrack::LidarTrack(const SimulationOptions& options, std::size_t index, const Scene& scene,
                       const SplineTrajectory& trajectory, const FaultMaker& faults)
    : options_(&options.lidars[index]),
      simulator_(std::make_unique<RangeSimulator>(
          scene, sensor_of(*options_),
          RangeMount{.trajectory = &trajectory, .T_body_lidar = options_->T_imu_lidar},
          seed_of(options.seed_of_noise(), index), options_->effects,
          options.cameras.empty() ? std::nullopt : std::optional(options.seed))),
      faults_(&faults),
      epoch_(options.epoch()),
      number_(index == 0 ? uint64_t{kPoints} : kFurtherPoints + index) {}

RangeSweep LidarTrack::sweep(std::size_t index, const Checkpoint& checkpoint) const {
  RangeSweep sweep = simulator_->sweep(static_cast<int64_t>(index), checkpoint);
  faults_->distort(sweep);
  return sweep;
}

void LidarTrack::write(const RangeSweep& sweep, std::size_t index, Nanoseconds received,
                       SimulationRecorder& recorder, ReturnTruthWriter& truth,
                       SimulationSummary& summary) const {
  if (seconds(received) < options_->begin || seconds(received) > options_->end) {
    return;
  }
  const ros::EncodedEvent message = cloud_message(
      sweep, options_->layout.value_or(simulator_->sensor().layout), epoch_, options_->frame);
  for (int copy = faults_->copies(number_, index, received); copy > 0; --copy) {
    recorder.write(options_->topic, received, message);
    ++summary.sweeps;
    summary.pulses += sweep.returns.size();
    summary.points += static_cast<std::size_t>(
        std::ranges::count_if(sweep.returns, [](const Return& back) { return back.range > 0.0; }));
    truth.write(sweep);
  }
}

}  // namespace adit
