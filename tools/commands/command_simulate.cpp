// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_simulate.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/simulator/faults.hpp"
#include "adit/tools/simulator/gnss_model.hpp"
#include "adit/tools/simulator/imu_model.hpp"
#include "adit/tools/simulator/motion.hpp"
#include "adit/tools/simulator/scene_file.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

std::vector<std::string> or_none(std::vector<std::string> names) {
  names.emplace_back("none");
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

/// The sensors, one after the other.
std::string sensors_of(const SimulationOptions& options) {
  std::string text;
  for (const LidarOptions& lidar : options.lidars) {
    text += (text.empty() ? "" : " and ") + lidar.sensor;
  }
  return text;
}

std::vector<CameraOptions> cameras_of(const SimulateCommandOptions& command) {
  std::vector<CameraOptions> cameras;
  for (const std::string& text : command.cameras) {
    try {
      cameras.push_back(camera_named(text));
    } catch (const UsageError& error) {
      throw UsageError(std::string("--camera: ") + error.what());
    }
    cameras.back().rate = command.camera_rate.value_or(cameras.back().rate);
  }
  return cameras;
}

std::string cameras_text(const SimulationOptions& options, const SimulationSummary& summary) {
  std::string text;
  for (const CameraOptions& camera : options.cameras) {
    text += fmt::format("{}{} {} {} Hz", text.empty() ? "" : ", ", camera.name, camera.lens,
                        camera.rate);
  }
  return text.empty() ? text : fmt::format("cameras   {} images ({})\n", summary.images, text);
}

/// What the command line asks for, or the scene file.
SimulationOptions simulation_of(const SimulateCommandOptions& command) {
  if (std::filesystem::path(command.simulation.scene).extension() == ".toml") {
    if (!command.besides_scene_file.empty()) {
      throw UsageError(command.besides_scene_file +
                       ": the scene file says all but -o; write it "
                       "there (`adit simulate --example` shows how).");
    }
    SimulationOptions options = read_scene_file(command.simulation.scene);
    options.output = command.simulation.output;
    options.picture = command.simulation.picture;
    return options;
  }
  SimulationOptions options = command.simulation;
  LidarOptions& lidar = options.lidars.front();
  if (!command.layout.empty()) {
    lidar.layout = cloud_layout_named(command.layout);
  }
  options.cameras = cameras_of(command);
  if (command.perfect) {
    lidar.effects = {.noise = false,
                     .dropout = false,
                     .mixed_pixels = false,
                     .dust = false,
                     .reflections = lidar.effects.reflections};
  }
  return options;
}

/// Empty where the way is free.
std::string crossing_note(const SimulationSummary& summary) {
  if (summary.crossings.empty()) {
    return {};
  }
  const Crossing& first = summary.crossings.front();
  return fmt::format(
      "note: the trajectory passes through walls or other solid things ({}), first after "
      "{:.1f} s at ({:.1f}, {:.1f}, {:.1f}) m; sweeps from within them show what no sensor sees. "
      "Other waypoints, corner_radius or --begin avoid it.\n",
      summary.crossings.size() == 1 ? "once" : fmt::format("{} times", summary.crossings.size()),
      first.time, first.at.x(), first.at.y(), first.at.z());
}

std::string summary_text(const SimulationOptions& options, const SimulationSummary& summary,
                         double seconds) {
  return fmt::format(
      "simulated {} sweeps of {} in {} ({} triangles), {:.1f} m, up to {:.2f} rad/s\n"
      "points    {:.0f} a sweep, {:.1f} % of the pulses\n"
      "imu       {} samples ({}, {} Hz)\n"
      "gnss      {} fixes{}\n"
      "{}{}{}"
      "time      {}, {:.2f} x real time\n",
      summary.sweeps, sensors_of(options), options.scene, summary.triangles, summary.path,
      summary.fastest_turn,
      static_cast<double>(summary.points) / static_cast<double>(summary.sweeps),
      100.0 * static_cast<double>(summary.points) / static_cast<double>(summary.pulses),
      summary.imu_samples, options.imu, options.imu_rate, summary.gnss_fixes,
      options.heading ? fmt::format(", {} headings", summary.headings) : "",
      options.wheels ? fmt::format("wheels    {} velocities ({} Hz)\n", summary.wheel_velocities,
                                   options.wheel_rate)
                     : "",
      options.visual_odometry ? fmt::format("odometry  {} poses ({} Hz)\n", summary.odometry_poses,
                                            options.visual_odometry_rate)
                              : "",
      cameras_text(options, summary), format_duration(seconds), options.duration / seconds);
}

/// Throws UsageError where a recording is there that is none of a simulation: those have their
/// truth beside them, and can be made again.
void require_free_output(const SimulateCommandOptions& command, const SimulationOptions& options) {
  std::error_code unknown;
  if (!command.overwrite && std::filesystem::exists(options.output, unknown) &&
      !std::filesystem::exists(SimulationFiles(options.output).trajectory, unknown)) {
    throw UsageError("-o: " + options.output.string() +
                     " is there already, and no simulation wrote it. Name another file, or give "
                     "--overwrite.");
  }
}

int run_simulation(const SimulateCommandOptions& command, std::ostream& out, std::ostream& err) {
  const SimulationOptions options = simulation_of(command);
  require_free_output(command, options);
  const auto start = std::chrono::steady_clock::now();
  std::optional<Progress> progress;
  const SimulationSummary summary = simulate(options, [&](std::size_t done, std::size_t total) {
    if (!progress) {
      progress.emplace(err, command.quiet ? ProgressStyle::none : progress_style_of_stderr(),
                       "simulating", total);
    }
    progress->update(done, 0);
  });
  if (progress) {
    progress->finish();
  }
  if (!command.quiet) {
    err << crossing_note(summary) << std::flush;
  }
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  if (!command.quiet) {
    const SimulationFiles files(options.output);
    out << summary_text(options, summary, elapsed.count()) << "wrote     "
        << files.recording.string() << "\n          " << files.trajectory.string()
        << " (T_world_lidar)\n          " << files.states.string()
        << " (IMU: pose, velocity, biases)\n          " << files.loops.string()
        << " (places that see the same)\n          " << files.surfaces.string()
        << " (what each return is of)\n          "
        << (options.cameras.empty()
                ? ""
                : files.colors.string() + " (the colour of its surface)\n          ")
        << (options.change.share > 0.0 ? fmt::format("{} ({} objects gone or new)\n          ",
                                                     files.changes.string(), summary.changes)
                                       : "")
        << files.scene.string() << ", " << files.picture.filename().string() << ", "
        << files.sweep.filename().string() << "\nnext      adit run " << files.recording.string()
        << " -o OUT\n          adit evaluate OUT/trajectory.tum " << files.trajectory.string()
        << std::endl;
  }
  return 0;
}

}  // namespace

int simulate_command(const SimulateCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit simulate", out, err, [&] { return run_simulation(options, out, err); });
}

void add_simulate_command(Command app, std::function<void(int)> done) {
  auto options = std::make_shared<SimulateCommandOptions>();
  SimulationOptions& simulation = options->simulation;
  const Command command = app.add_command(
      "simulate", "Write a recording of a simulated place, with the truth beside it");
  command.footer(
      "Scenes:       " + listed(scene_names()) + "\nSensors:      " + listed(range_sensor_names()) +
      "\nTrajectories: " + listed(motion_names()) + "\nIMUs:         " +
      listed(or_none(imu_names())) + "\nReceivers:    " + listed(or_none(gnss_names())) +
      "\nCameras:      " + listed(camera_names()) + "\nLenses:       " +
      listed(camera_lens_names()) + "\nFaults:       " + listed(fault_names()) +
      "\n\n"
      "The same options give the same bytes on any machine.\n\n"
      "Examples:\n"
      "  adit simulate mine -o mine.mcap\n"
      "  adit simulate room -o room.mcap --sensor Mid-360 --trajectory handheld --duration 30\n"
      "  adit simulate --example > my.toml; adit simulate my.toml -o my.mcap\n\n"
      "Exit codes: 0 done, 1 failed, 2 usage.");
  command.option("scene", simulation.scene, "Where, or a TOML file that says everything")
      .required()
      .value_name("SCENE")
      .suggest(scene_names())
      .file();
  command
      .option("-o,--output", simulation.output,
              "The recording to write; the truth comes "
              "beside it")
      .required()
      .value_name("FILE.mcap")
      .written({".mcap"});
  command.flag("--overwrite", options->overwrite,
               "Replace FILE.mcap also where it is no simulated recording");
  command.option("--sensor", simulation.lidars.front().sensor, "Range sensor")
      .value_name("NAME")
      .suggest(range_sensor_names())
      .show_default();
  command.option("--trajectory", simulation.trajectory, "How the sensor is carried")
      .value_name("NAME")
      .suggest(motion_names())
      .show_default();
  command.option("--duration", simulation.duration, "Length (s)").value_name("S").show_default();
  command.option("--speed", simulation.speed, "Speed (m/s), instead of the scene's")
      .value_name("V");
  command.option("--begin", simulation.begin, "Where along the scene's route it begins (m)")
      .value_name("M")
      .show_default();
  command.option("--seed", simulation.seed, "Another seed, another world and other noise")
      .from(0.0)
      .value_name("N")
      .show_default();
  command
      .option("--noise-seed", simulation.noise_seed,
              "Another seed of the sensors' errors alone: the same place, recorded again")
      .value_name("N");
  command
      .option("--later", simulation.later,
              "Seconds that the recording begins later: what moves has gone on")
      .value_name("S")
      .show_default();
  command
      .option("--change", simulation.change.share,
              "Share of the scene's movable objects that are gone, moved or more than without it")
      .value_name("SHARE")
      .show_default();
  const CommandOption change_seed =
      command.option("--change-seed", simulation.change.seed, "Another seed, other objects change")
          .from(0.0)
          .value_name("N")
          .show_default();
  command.flag("--reverse", simulation.reverse, "Take the route from its end to its beginning");
  command.option("--imu", simulation.imu, "Inertial sensor")
      .value_name("NAME")
      .suggest(or_none(imu_names()))
      .show_default();
  const CommandOption imu_rate = command.option("--imu-rate", simulation.imu_rate, "Its rate (Hz)")
                                     .value_name("HZ")
                                     .show_default();
  command.option("--gnss", simulation.gnss, "GNSS receiver")
      .value_name("NAME")
      .suggest(or_none(gnss_names()))
      .show_default();
  const CommandOption gnss_rate =
      command.option("--gnss-rate", simulation.gnss_rate, "Its rate (Hz)")
          .value_name("HZ")
          .show_default();
  command.flag("--heading", simulation.heading,
               "Headings of the receiver's two antennas on /heading");
  const CommandOption heading_sigma =
      command
          .option("--heading-sigma", simulation.heading_errors.sigma,
                  "Their standard deviation (degrees)")
          .value_name("DEG")
          .show_default();
  const CommandOption heading_offset =
      command
          .option("--heading-offset", simulation.heading_errors.offset,
                  "An error that all of them have (degrees, counter-clockwise)")
          .value_name("DEG")
          .show_default();
  command.flag("--wheels", simulation.wheels,
               "Velocities of a vehicle's wheels on /wheels, for drive, stop-and-go, moving-start");
  command.flag("--visual-odometry", simulation.visual_odometry,
               "Poses of a camera's odometry, whose scale drifts, on /visual_odometry");
  command
      .option("--camera", options->cameras,
              "A camera, with images on /camera_NAME/image_raw; may be given again")
      .one_value_each()
      .value_name("NAME[:LENS]")
      .suggest(camera_names());
  const CommandOption camera_rate = command
                                        .option("--camera-rate", options->camera_rate,
                                                "Images a second of each camera (Hz), instead of 2")
                                        .value_name("HZ");
  command.flag("--doppler", simulation.lidars.front().doppler,
               "The range sensor measures the radial speed of each return");
  command.option("--fault", simulation.faults, "Something that is wrong; may be given again")
      .one_value_each()
      .value_name("NAME")
      .suggest(fault_names());
  command
      .option("--fields", options->layout,
              "Lay clouds out as another driver: velodyne, ouster, hesai, livox")
      .value_name("DRIVER")
      .suggest({"velodyne", "ouster", "hesai", "livox"});
  command.flag("--reflections", simulation.lidars.front().effects.reflections,
               "Panes of glass mirror: the range sensor measures what is in them behind them");
  command.flag("--perfect", options->perfect, "A range sensor without errors");
  command.flag("--quiet", options->quiet, "Print errors alone");
  command.flag(
      "--example",
      [] {
        std::cout << scene_file_example() << std::flush;
        end_parsing();
      },
      "Print a scene file with every key and stop");
  command.action([command, options, imu_rate, gnss_rate, heading_sigma, heading_offset, camera_rate,
                  change_seed, done = std::move(done)] {
    options->besides_scene_file = command.given_besides({"scene", "--output", "--quiet"});
    if (imu_rate.given() && options->simulation.imu == "none") {
      refuse_option("--imu-rate", "there is no IMU that it is of; leave out --imu none");
    }
    if (gnss_rate.given() && options->simulation.gnss == "none") {
      refuse_option("--gnss-rate", "there is no receiver that it is of; name one with --gnss");
    }
    for (const auto& [name, option] :
         {std::pair("--heading-sigma", heading_sigma), {"--heading-offset", heading_offset}}) {
      if (option.given() && !options->simulation.heading) {
        refuse_option(name, "there is no heading that it is of; add it with --heading");
      }
    }
    if (camera_rate.given() && options->cameras.empty()) {
      refuse_option("--camera-rate", "there is no camera that it is of; add one with --camera");
    }
    if (change_seed.given() && options->simulation.change.share == 0.0) {
      refuse_option("--change-seed", "nothing changes; give the share that does with --change");
    }
    done(simulate_command(*options, std::cout, std::cerr));
  });
}

}  // namespace adit
