// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/simulation.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <system_error>
#include <utility>

#include "adit/tools/simulator/faults.hpp"
#include "adit/tools/simulator/loop_pairs.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/scene_picture.hpp"
#include "adit/tools/simulator/simulation_limits.hpp"
#include "adit/tools/simulator/simulation_tracks.hpp"
#include "adit/tools/simulator/sweep_picture.hpp"
#include "adit/tools/simulator/truth_writer.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// What is refused, with the name of what asks for it.
template <class Require>
void check_option(const char* name, const Require& require) {
  try {
    require();
  } catch (const UsageError& error) {
    throw UsageError(std::string(name) + ": " + error.what());
  }
}

void require_doppler(const LidarOptions& lidar) {
  const CloudLayout layout = lidar.layout.value_or(range_sensor_named(lidar.sensor).layout);
  if (lidar.doppler && layout == CloudLayout::livox) {
    throw UsageError(
        "Livox's CustomMsg has no field for speeds. Choose --fields velodyne, or another "
        "sensor.");
  }
}

void check(const SimulationOptions& options) {
  check_option("--duration", [&] { require_duration(options.duration); });
  check_option("--change", [&] { require_change(options.change.share); });
  check_option("--later", [&] { require_later(options.later); });
  check_option("--imu-rate", [&] { require_imu_rate(options.imu_rate); });
  check_option("--gnss-rate", [&] { require_gnss_rate(options.gnss_rate); });
  check_option("--fault", [&] {
    require_seen(options.faults, options.duration,
                 {.imu = options.imu != "none",
                  .wheels = options.wheels,
                  .visual_odometry = options.visual_odometry,
                  .heading = options.heading,
                  .camera = !options.cameras.empty()});
  });
  if (options.heading) {
    check_option("--heading", [&] {
      require_heading_errors(options.heading_errors);
      if (options.gnss == "none") {
        throw UsageError("there is no receiver that it is of; name one with --gnss.");
      }
    });
  }
  if (options.wheels) {
    check_option("--wheels", [&] {
      require_wheels(motion_named(options.trajectory));
      require_wheel_rate(options.wheel_rate);
    });
  }
  if (options.visual_odometry) {
    check_option("--visual-odometry", [&] { require_wheel_rate(options.visual_odometry_rate); });
  }
  check_option("--doppler", [&] {
    for (const LidarOptions& lidar : options.lidars) {
      require_doppler(lidar);
    }
  });
  check_option("--camera", [&] { require_cameras(options.cameras); });
  if (options.speed) {
    check_option("--speed", [&] { require_speed(*options.speed); });
  }
  if (options.lidars.empty()) {
    throw UsageError("at least one range sensor is needed.");
  }
  if (!options.waypoints.empty()) {
    check_option("waypoints", [&] { require_way(options.waypoints); });
  }
  if (options.corner_radius) {
    check_option("corner_radius", [&] { require_corner_radius(*options.corner_radius); });
  }
  check_option("--begin", [&] { require_begin(options.begin); });
  if (options.output.extension() != ".mcap") {
    throw UsageError(
        "-o: the recording is written as MCAP; name it NAME.mcap. `adit convert` "
        "makes other formats of it.");
  }
}

std::vector<RangeSweep> sweeps_at(const std::vector<LidarTrack>& lidars, std::size_t index,
                                  const Checkpoint& checkpoint) {
  std::vector<RangeSweep> sweeps;
  for (const LidarTrack& lidar : lidars) {
    sweeps.push_back(lidar.sweep(index, checkpoint));
  }
  return sweeps;
}

Scene scene_of(const SimulationOptions& options) {
  Scene scene = make_scene(options.scene, options.seed);
  if (!options.waypoints.empty()) {
    scene.route = options.waypoints;
    // Motions begin where the rounding of the second corner does.
    std::ranges::rotate(scene.route, scene.route.end() - 1);
  }
  scene.corner_radius = options.corner_radius.value_or(scene.corner_radius);
  if (options.reverse) {
    std::ranges::reverse(scene.route);
  }
  for (MovingObject& object : scene.moving) {
    object.T_world_object = [at = std::move(object.T_world_object),
                             later = options.later](double time) { return at(time + later); };
  }
  return scene;
}

/// The scene with what has changed in it, or as it is where nothing is to change. Throws UsageError
/// where it has no movable object.
ChangedScene with_changes(Scene scene, const SimulationOptions& options) {
  if (options.change.share == 0.0) {
    return {.scene = std::move(scene)};
  }
  if (scene.mesh.movable.empty()) {
    throw UsageError("--change: the scene " + options.scene +
                     " has no movable objects. City, mine, office, room and wings have some.");
  }
  return changed_scene(std::move(scene), options.change);
}

/// Where the sensor comes by again; it looks in some hundred of its directions.
std::vector<LoopPair> find_loops(const RangeSimulator& lidar, double duration,
                                 const Checkpoint& checkpoint) {
  const std::vector<Firing> firings = firings_of(lidar.sensor(), 0);
  constexpr std::size_t kDirections = 384;
  std::vector<Eigen::Vector3d> directions;
  for (std::size_t i = 0; i < kDirections; ++i) {
    directions.push_back(firings[i * firings.size() / kDirections].direction);
  }
  return find_loops([&](double time) { return lidar.pose(time); }, duration, directions,
                    lidar.still(), {}, checkpoint);
}

/// The motion that is recorded.
SplineTrajectory motion_of(const Scene& scene, const SimulationOptions& options,
                           const Checkpoint& checkpoint) {
  const MotionStyle style = motion_named(options.trajectory);
  const auto motion = [&](double duration) {
    return make_trajectory(scene, style, duration + 0.5, options.speed, options.begin, checkpoint);
  };
  return std::ranges::count(options.faults, "kidnapped") == 0
             ? motion(options.duration)
             : motion(options.duration + kCarried)
                   .cut_out(time_of_kidnap(options.duration), kCarried);
}

std::vector<Fault> faults_of(const SimulationOptions& options) {
  std::vector<Fault> faults;
  for (const std::string& name : options.faults) {
    faults.push_back(fault_named(name));
  }
  return faults;
}

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

void write_mounts(const SimulationOptions& options, const FaultMaker& faults,
                  SimulationRecorder& recorder) {
  for (const LidarOptions& lidar : options.lidars) {
    recorder.write("/tf_static", Nanoseconds(0),
                   StaticTransform{kImuFrame, lidar.frame, lidar.T_imu_lidar}, kImuFrame);
  }
  if (options.gnss != "none") {
    Eigen::Isometry3d T_imu_antenna = Eigen::Isometry3d::Identity();
    T_imu_antenna.translation() = options.p_imu_antenna;
    recorder.write("/tf_static", Nanoseconds(0),
                   StaticTransform{kImuFrame, kAntennaFrame, T_imu_antenna}, kImuFrame);
  }
  if (options.wheels) {
    recorder.write("/tf_static", Nanoseconds(0),
                   StaticTransform{kImuFrame, kWheelFrame, options.T_imu_wheels}, kImuFrame);
  }
  if (options.visual_odometry) {
    recorder.write("/tf_static", Nanoseconds(0),
                   StaticTransform{kImuFrame, kCameraFrame, options.T_imu_camera}, kImuFrame);
  }
  for (const CameraOptions& camera : options.cameras) {
    recorder.write(
        "/tf_static", Nanoseconds(0),
        StaticTransform{kImuFrame, camera.frame(), faults.stated_mount(camera.T_imu_camera)},
        kImuFrame);
  }
}

/// The sensors beside the range sensors.
struct Tracks {
  /// What it is given must outlive it.
  Tracks(const SimulationOptions& options, const SimulationFiles& files,
         const SplineTrajectory& trajectory, const SceneCaster& scene, const FaultMaker& faults)
      : imu(options, files, trajectory, faults) {
    if (options.gnss != "none") {
      gnss.emplace(options, files, trajectory, scene.still(), faults);
    }
    if (options.heading) {
      heading.emplace(options, trajectory, faults);
    }
    if (options.wheels) {
      wheels.emplace(options, files, trajectory, faults);
    }
    if (options.visual_odometry) {
      odometry.emplace(options, trajectory, faults);
    }
    for (std::size_t i = 0; i < options.cameras.size(); ++i) {
      cameras.emplace_back(options, i, scene, trajectory, faults);
    }
  }

  ImuTrack imu;
  std::optional<GnssTrack> gnss{};
  std::optional<WheelTrack> wheels{};
  std::optional<PoseTrack> odometry{};
  std::optional<HeadingTrack> heading{};
  std::vector<CameraTrack> cameras{};

  /// What they measure before `end`, in the order of time.
  void write_until(Nanoseconds end, SimulationRecorder& recorder, SimulationSummary& summary,
                   const Checkpoint& checkpoint) {
    const auto time_of = [](const auto& track) {
      return track ? track->time() : Nanoseconds::max();
    };
    const auto next_camera = [&] {
      return std::ranges::min_element(cameras, {},
                                      [](const auto& camera) { return camera.time(); });
    };
    const auto first = [&] {
      return std::min({imu.time(), time_of(gnss), time_of(wheels), time_of(odometry),
                       time_of(heading),
                       cameras.empty() ? Nanoseconds::max() : next_camera()->time()});
    };
    for (Nanoseconds next = first(); next < end; next = first()) {
      if (next == imu.time()) {
        imu.write_next(recorder, summary);
      } else if (next == time_of(gnss)) {
        gnss->write_next(recorder, summary);
      } else if (next == time_of(wheels)) {
        wheels->write_next(recorder, summary);
      } else if (next == time_of(heading)) {
        heading->write_next(recorder, summary);
      } else if (next == time_of(odometry)) {
        odometry->write_next(recorder, summary);
      } else {
        next_camera()->write_next(recorder, summary, checkpoint);
      }
    }
  }

  void close() {
    imu.close();
    if (gnss) {
      gnss->close();
    }
    if (wheels) {
      wheels->close();
    }
  }
};

std::filesystem::path beside(const std::filesystem::path& recording, const char* ending) {
  return recording.parent_path() / (recording.stem().string() + ending);
}

}  // namespace

SimulationFiles::SimulationFiles(const std::filesystem::path& file)
    : recording(file),
      trajectory(beside(file, ".truth.tum")),
      states(beside(file, ".truth.csv")),
      antenna(beside(file, ".truth.antenna.csv")),
      wheels(beside(file, ".truth.wheels.csv")),
      loops(beside(file, ".truth.loops.csv")),
      labels(beside(file, ".truth.labels")),
      surfaces(beside(file, ".truth.surfaces")),
      colors(beside(file, ".truth.colors")),
      changes(beside(file, ".truth.changes.json")),
      scene(beside(file, ".scene.ply")),
      picture(beside(file, ".scene.png")),
      sweep(beside(file, ".sweep.png")) {}

Eigen::Isometry3d lidar_mount() {
  Eigen::Isometry3d T_imu_lidar = Eigen::Isometry3d::Identity();
  T_imu_lidar.translation() = Eigen::Vector3d(0.03, -0.01, 0.08);
  return T_imu_lidar;
}

SimulationSummary simulate(const SimulationOptions& options,
                           const std::function<void(std::size_t done, std::size_t total)>& progress,
                           const Checkpoint& checkpoint) {
  check(options);
  Scene scene = scene_of(options);
  const std::size_t movable = scene.mesh.movable.size();
  ChangedScene changed = with_changes(std::move(scene), options);
  scene = std::move(changed.scene);
  const SplineTrajectory trajectory = motion_of(scene, options, checkpoint);
  scene = out_of_the_way(
      std::move(scene), [&](double time) { return trajectory.pose(time); }, options.duration,
      kClearance, checkpoint);
  const FaultMaker fault_maker(faults_of(options), options.duration, options.seed_of_noise());
  const SimulationFiles files(options.output);
  ReturnTruthWriter truth(files.surfaces,
                          scene.moving.empty() ? std::nullopt : std::optional(files.labels),
                          options.cameras.empty() ? std::nullopt : std::optional(files.colors));
  std::vector<LidarTrack> lidars;
  for (std::size_t i = 0; i < options.lidars.size(); ++i) {
    lidars.emplace_back(options, i, scene, trajectory, fault_maker);
  }
  const RangeSimulator& first = lidars.front().simulator();
  SimulationSummary summary{.triangles = scene.mesh.triangles.size(),
                            .changes = changed.changes.size()};
  summary.crossings = find_crossings([&](double time) { return first.pose(time); },
                                     options.duration, first.still(), checkpoint);
  Tracks tracks(options, files, trajectory, first.caster(), fault_maker);
  SimulationRecorder recorder(options);
  write_mounts(options, fault_maker, recorder);
  const auto total = static_cast<std::size_t>(
      std::floor(options.duration * 1e9 / static_cast<double>(first.sensor().period) + 1e-6));
  for (std::size_t i = 0; i < total; ++i) {
    const std::vector<RangeSweep> sweeps = sweeps_at(lidars, i, checkpoint);
    const Nanoseconds end(sweeps.front().start + first.sensor().period);
    tracks.write_until(end, recorder, summary, checkpoint);
    for (std::size_t k = 0; k < lidars.size(); ++k) {
      lidars[k].write(sweeps[k], i, end, recorder, truth, summary);
    }
    if (progress) {
      progress(i + 1, total);
    }
  }
  recorder.close();
  if (fault_maker.has(Fault::truncated)) {
    cut_off(files.recording);
  }
  tracks.close();
  truth.close();
  if (options.change.share > 0.0) {
    write_changes(files.changes, options.change, movable, changed.changes);
  }
  write_scene_ply(files.scene, scene);
  write_loops(files.loops, find_loops(first, options.duration, checkpoint),
              seconds(options.epoch()));
  if (options.picture) {
    write_scene_picture(files.picture, scene, first.still(), trajectory, checkpoint);
    write_sweep_picture(files.sweep, scene, first, static_cast<int64_t>(total / 3), checkpoint);
  }
  return summary;
}

}  // namespace adit
