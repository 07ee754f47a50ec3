// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_map_page.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/drawing/map_page.hpp"
#include "adit/tools/results/sweep_table.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/run/run_loops_section.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

double largest_sigma(const PoseUncertainty& uncertainty) {
  return std::sqrt(uncertainty.in_map().diagonal().head<3>().maxCoeff());
}

}  // namespace

void write_map_page(const RunFiles& files, const PageCloud& cloud, const std::string& recording) {
  const Trajectory trajectory = read_trajectory(files.tum);
  const std::vector<SweepRecord> sweeps = read_sweep_table(files.sweeps);
  MapPage page{.title = recording, .headline = {}, .points = {}, .poses = {}};
  double length = 0.0;
  for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
    const StampedPose& pose = trajectory.poses[i];
    const StampedPose& first = trajectory.poses.front();
    PagePose told{
        .time = seconds(pose.stamp - first.stamp),
        .p = pose.pose.translation(),
        .state = {},
        .registration = {},
        .imu = {},
        .overlap = kUnknown,
        .residual_rms = kUnknown,
        .sigma = kUnknown,
    };
    if (i < sweeps.size()) {
      told.state = sweeps[i].state;
      told.registration = sweeps[i].registration;
      told.imu = sweeps[i].imu;
      told.overlap = sweeps[i].overlap;
      told.residual_rms = sweeps[i].residual_rms;
      told.sigma = largest_sigma(sweeps[i].uncertainty);
    }
    length += i > 0 ? (told.p - page.poses.back().p).norm() : 0.0;
    page.poses.push_back(std::move(told));
  }
  for (const SeenFrom& point : cloud.points()) {
    if (point.pose < trajectory.poses.size()) {
      const Eigen::Vector3d p = trajectory.poses[point.pose].pose * point.p.cast<double>();
      page.points.push_back(
          {.p = p.cast<float>(), .intensity = point.intensity, .pose = point.pose});
    }
  }
  page.headline =
      fmt::format("{} sweeps, {:.1f} m, {:.1f} s; {} points", page.poses.size(), length,
                  page.poses.empty() ? 0.0 : page.poses.back().time, page.points.size());
  LoopsSection loops = run_loops_section(files);
  page.section = std::move(loops.headline);
  page.details = std::move(loops.body);
  write_text_file(files.page, map_page(page));
}

}  // namespace adit
