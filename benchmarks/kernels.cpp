// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Device time of each kernel family on sweeps of a synthetic street, from device timestamps; beside
// it the time from recording to the end of the wait. Every case is compared with its twin first,
// and not timed where it is wrong.
//
//   kernels_benchmark [--benchmark_filter=REGEX] [google-benchmark's other options]
//
// The device is the one of the environment's ADIT_DEVICE, else the best there is.
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include <benchmark/benchmark.h>

#include "benchmarks/peers.hpp"
#include "engine/context.hpp"
#include "slam/registration.hpp"
#include "tests/kernels/alignment_scene.hpp"
#include "tests/kernels/cases.hpp"
#include "tests/kernels/device_runs.hpp"
#include "tests/kernels/verify.hpp"

namespace adit::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// What a benchmark times, made ready and verified.
struct Work {
  std::string problem{};               ///< of the verification; empty: none
  std::function<test::Times()> run{};  ///< one submission and a wait
  std::function<void()> undo{};        ///< not timed, after each run; may be empty
  std::string scope{};                 ///< whose device time counts
  uint64_t points = 0;                 ///< that the kernels read
  uint64_t bytes = 0;  ///< inputs and outputs once each: the least a run has to move
};

void time_on_device(benchmark::State& state, const Work& work) {
  if (!work.problem.empty()) {
    state.SkipWithError(("differs from its twin: " + work.problem).c_str());
    return;
  }
  double device_seconds = 0.0;
  double host_seconds = 0.0;
  for ([[maybe_unused]] auto iteration : state) {
    const Clock::time_point begin = Clock::now();
    const test::Times times = work.run();
    host_seconds += std::chrono::duration<double>(Clock::now() - begin).count();
    const double seconds = 1e-3 * test::device_ms(times, work.scope);
    state.SetIterationTime(seconds);
    device_seconds += seconds;
    if (work.undo) {
      work.undo();
    }
  }
  const auto runs = static_cast<double>(state.iterations());
  state.counters["points"] = static_cast<double>(work.points);
  state.counters["ns_a_point"] = 1e9 * device_seconds / runs / static_cast<double>(work.points);
  state.counters["submit_to_wait_ms"] = 1e3 * host_seconds / runs;
  state.SetBytesProcessed(static_cast<int64_t>(work.bytes) *
                          static_cast<int64_t>(state.iterations()));
}

std::string first_problem(const test::Verdict& verdict) {
  return verdict.passed() ? std::string() : verdict.problems.front();
}

/// `scope` is one that Preprocess records, or "preprocess" for all of them.
Work preprocess(engine::Context& context, int points, const std::string& scope) {
  const test::SweepCase sweep = test::street_sweep(points);
  const auto run = std::make_shared<test::PreprocessRun>(context, sweep.settings, sweep.raw);
  run->run();
  const uint64_t cloud_points = run->counters().cloud_points;
  Work work{.scope = scope, .points = scope == "surfaces" ? cloud_points : sweep.raw.size()};
  work.problem = first_problem(
      scope == "surfaces"
          ? test::verify_surfaces(sweep.settings, run->cloud(), run->surface_cloud())
          : test::verify_downsample(sweep.settings, sweep.raw, run->counters(), run->cloud()));
  work.run = [run] { return run->run(); };
  work.bytes = (scope == "surfaces" ? cloud_points : sweep.raw.size()) * sizeof(Point) +
               cloud_points * sizeof(Point) * (scope == "preprocess" ? 3 : 1);
  return work;
}

Work voxel_map_add(engine::Context& context, int points) {
  const auto scene =
      std::make_shared<test::AlignmentScene>(context, test::street_alignment(points));
  const auto cloud = std::make_shared<test::DeviceCloud>(context, scene->source());
  const auto map =
      std::make_shared<test::VoxelMapRun>(context, scene->target().voxel_size, 1U << 15U);
  // At the identity and in voxels of 1 m the arithmetic is exact: no point is left out.
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  map->add(*cloud, pose);
  reference::VoxelMap expected{.voxel_size = scene->target().voxel_size};
  expected.add(reference::decode(scene->source()), pose);
  Work work{.scope = "add", .points = cloud->size()};
  work.problem = first_problem(test::verify_voxel_map(expected, map->cells()));
  work.run = [map, cloud, pose] { return map->add(*cloud, pose); };
  work.undo = [map, cloud, pose] { map->remove(*cloud, pose); };
  work.bytes =
      cloud->size() * sizeof(gpu::uvec4) + expected.voxels.size() * sizeof(gpu::GaussianCell);
  return work;
}

std::string problem_of_system(engine::Context& context, const test::AlignmentScene& scene,
                              const Eigen::Isometry3d& pose) {
  const double d_max = scene.settings().d_max;
  const std::vector<gpu::uvec4> certain = scene.certain_source(pose, d_max);
  const test::DeviceCloud cloud(context, certain);
  test::AlignmentRun run(context, scene.kernels(), cloud, scene.map(), scene.settings());
  run.evaluate(pose);
  const std::vector<reference::Match> matches =
      reference::find_matches(reference::decode(certain), scene.target(), pose, d_max);
  return first_problem(test::verify_system(reference::linearize(matches), run.state(), 1e-3));
}

struct Alignment {
  test::AlignmentScene scene;
  test::DeviceCloud source;
  test::AlignmentRun vgicp;

  Alignment(engine::Context& context, int points)
      : scene(context, test::street_alignment(points)),
        source(context, scene.source()),
        vgicp(context, scene.kernels(), source, scene.map(), scene.settings()) {}
};

uint64_t bytes_of(const Alignment& alignment) {
  return alignment.source.size() * sizeof(gpu::uvec4) +
         alignment.scene.target().voxels.size() * sizeof(gpu::GaussianCell);
}

Work registration_linearize(engine::Context& context, int points) {
  const auto alignment = std::make_shared<Alignment>(context, points);
  const Eigen::Isometry3d pose = alignment->scene.T_target_source();
  Work work{.scope = "align", .points = alignment->source.size(), .bytes = bytes_of(*alignment)};
  work.problem = problem_of_system(context, alignment->scene, pose);
  work.run = [alignment, pose] { return alignment->vgicp.evaluate(pose); };
  return work;
}

Work vgicp_align(engine::Context& context, int points) {
  const auto alignment = std::make_shared<Alignment>(context, points);
  const test::AlignmentScene& scene = alignment->scene;
  const Eigen::Isometry3d start = retract(scene.T_target_source(), test::offsets().back().second);
  alignment->vgicp.align(start);
  const test::DeviceOutcome state = alignment->vgicp.state();
  const reference::Alignment expected =
      reference::align(reference::decode(scene.source()), scene.target(), start, scene.settings());
  const double error = (from_device(state.pose).translation() - expected.pose.translation()).norm();
  Work work{.scope = "align", .points = alignment->source.size()};
  work.bytes = (state.iterations + 1) * bytes_of(*alignment);
  if (state.converged == 0 || !(error < 2e-4)) {
    work.problem = "the pose is " + std::to_string(1e3 * error) + " mm from the twin's";
  }
  work.run = [alignment, start] { return alignment->vgicp.align(start); };
  return work;
}

/// Notes on stderr what did not verify: google-benchmark's own exit status does not tell.
class Failures {
 public:
  void add(const std::string& name, const std::string& problem) {
    std::cerr << name << ": " << problem << '\n';
    count_ += 1;
  }
  int count() const { return count_; }

 private:
  int count_ = 0;
};

void register_kernels(engine::Context& context, Failures& failures) {
  using Make = std::function<Work(int)>;
  const std::vector<std::pair<std::string, Make>> kernels = {
      {"downsample", [&](int n) { return preprocess(context, n, "downsample"); }},
      {"surfaces", [&](int n) { return preprocess(context, n, "surfaces"); }},
      {"preprocess", [&](int n) { return preprocess(context, n, "preprocess"); }},
      {"voxel_map_add", [&](int n) { return voxel_map_add(context, n); }},
      {"registration_linearize", [&](int n) { return registration_linearize(context, n); }},
      {"vgicp_align", [&](int n) { return vgicp_align(context, n); }}};
  for (const auto& [name, make] : kernels) {
    for (const int points : test::kTimedSizes) {
      const std::string full = name + "/" + std::to_string(points);
      benchmark::RegisterBenchmark(full.c_str(),
                                   [&failures, full, make = make, points](benchmark::State& state) {
                                     const Work work = make(points);
                                     if (!work.problem.empty()) {
                                       failures.add(full, work.problem);
                                     }
                                     time_on_device(state, work);
                                   })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 2;
  }
  const char* device = std::getenv("ADIT_DEVICE");
  engine::Context context({.device = device == nullptr ? "" : device, .profile = true});
  const engine::DeviceInfo& info = context.device();
  benchmark::AddCustomContext("device", info.name + (info.software ? " (software)" : ""));
  benchmark::AddCustomContext("driver", info.driver + " " + info.driver_version);
  benchmark::AddCustomContext("vulkan", info.api_version);
  Failures failures;
  register_kernels(context, failures);
  benchmark::AddCustomContext("peers", register_peers());
  benchmark::RunSpecifiedBenchmarks();
  return failures.count() == 0 ? 0 : 1;
}

}  // namespace
}  // namespace adit::bench

int main(int argc, char** argv) {
  try {
    return adit::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "kernels_benchmark: " << error.what() << '\n';
    return 3;
  }
}
