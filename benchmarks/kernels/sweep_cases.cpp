// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A sweep as the odometry takes it, all of it: what `adit run` does for each but reading and
// writing.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "adit/benchmarks/kernels/cases.hpp"
#include "adit/benchmarks/kernels/inputs.hpp"
#include "adit/benchmarks/kernels/timing.hpp"
#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/odometry/odometry.hpp"

namespace adit::bench {
namespace {

constexpr std::size_t kSweeps = 24;
constexpr double kStep = 0.3;       // m from sweep to sweep
constexpr double kFarthest = 0.05;  // m from the truth, at the end of the way
constexpr int kBeams = 64;

/// A drive along a street, and on its sweeps to and fro for ever.
struct Drive {
  Drive(engine::Context& context, const Config& config) : odometry(context, config) {}

  Odometry odometry;
  std::vector<Sweep> sweeps{};
  std::size_t taken = 0;
  SweepResult last{};

  void step() {
    const std::size_t turn = taken % (2 * kSweeps - 2);
    Sweep& sweep = sweeps[turn < kSweeps ? turn : 2 * kSweeps - 2 - turn];
    sweep.stamp = std::chrono::milliseconds(100) * static_cast<int64_t>(taken);
    last = odometry.step(sweep);
    ++taken;
  }
};

Work drive(Bench& bench, int points) {
  const test::World world = test::make_street(60.0);
  Config config;
  config.imu.use = false;
  const auto state = std::make_shared<Drive>(bench.context(), config);
  const std::vector<StampedPose> poses = test::steady_drive(kSweeps, test::twist(kStep, 0.005));
  for (const StampedPose& pose : poses) {
    state->sweeps.emplace_back().points =
        test::scan(world, pose, {.beams = kBeams, .columns = std::max(points / kBeams, 16)}).points;
  }
  while (state->taken < kSweeps) {
    state->step();
  }
  const Eigen::Isometry3d truth = poses.front().pose.inverse() * poses.back().pose;
  const double error = (truth.inverse() * state->last.T_map_lidar).translation().norm();
  const engine::RecordedWork& work = state->last.device_work;
  Work made{.verified_by = "true pose",
            .items = state->sweeps.front().points.size(),
            .cost = {.bytes = 32.0 * static_cast<double>(state->last.raw_points),
                     .dispatches = static_cast<double>(work.dispatches)}};
  made.figures = {{"error mm", 1e3 * error},
                  {"points left", state->last.cloud_points},
                  {"iterations", state->last.registration.iterations},
                  {"dispatches", work.dispatches},
                  {"barriers", work.barriers},
                  {"KiB up", static_cast<double>(work.upload_bytes) / 1024.0},
                  {"KiB down", static_cast<double>(work.readback_bytes) / 1024.0}};
  if (!(error < kFarthest)) {
    made.problem = "the drive ends " + std::to_string(1e3 * error) + " mm from the truth";
  }
  made.run = [state] {
    Sample sample = time_on_host([&] { state->step(); });
    sample.wait_ms = state->last.wait_ms;
    sample.device_ms =
        std::accumulate(state->last.stages.begin(), state->last.stages.end(), 0.0,
                        [](double sum, const StageTime& stage) { return sum + stage.device_ms; });
    return sample;
  };
  return made;
}

}  // namespace

std::vector<Case> sweep_cases() {
  return {{.name = "sweep/odometry",
           .kind = CaseKind::registration,
           .least = 20'000,  // with fewer the street's rings are too far apart
           .make = [](Bench& bench, int points) { return drive(bench, points); }}};
}

}  // namespace adit::bench
