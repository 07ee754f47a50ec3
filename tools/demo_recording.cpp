// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/demo_recording.hpp"

#include <cstdio>
#include <string>
#include <vector>

#include "tools/output_file.hpp"
#include "tools/trajectory_io.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

fs::path sweep_file(const fs::path& folder, std::size_t index) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.bin", index);
  return folder / name;
}

void write_sweep(const fs::path& path, const Sweep& sweep) {
  OutputFile file(path);
  file.write(sweep.points.data(), sweep.points.size() * sizeof(Point));
  file.close();
}

std::string seconds_text(Nanoseconds stamp) {
  char text[48];
  std::snprintf(text, sizeof text, "%.6f\n", std::chrono::duration<double>(stamp).count());
  return text;
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw OutputError(folder, folder.string() + ": the folder cannot be made: " + error.message() +
                                  ". Choose another one with -o.");
  }
}

}  // namespace

DemoFiles::DemoFiles(const fs::path& folder)
    : recording(folder / "recording"), truth(folder / "truth.tum") {}

DemoFiles write_demo_recording(const fs::path& folder, const DemoDrive& drive,
                               const SpinningLidar& lidar,
                               const std::function<void(std::size_t)>& progress) {
  DemoFiles files(folder);
  const fs::path sweeps = files.recording / "velodyne";
  make_folder(sweeps);
  Random random(1);
  std::string times;
  std::vector<StampedPose> truth;
  for (std::size_t i = 0; i < drive.poses.size(); ++i) {
    const StampedPose& pose = drive.poses[i];
    write_sweep(sweep_file(sweeps, i), scan(drive.scene, pose, lidar, random));
    times += seconds_text(pose.stamp);
    truth.push_back({.stamp = pose.stamp, .pose = drive.poses.front().pose.inverse() * pose.pose});
    if (progress) {
      progress(i + 1);
    }
  }
  std::error_code ignored;
  for (std::size_t i = drive.poses.size(); fs::remove(sweep_file(sweeps, i), ignored); ++i) {
  }
  write_text_file(files.recording / "times.txt", times);
  write_trajectory(files.truth, TrajectoryFormat::tum, truth);
  return files;
}

}  // namespace adit
