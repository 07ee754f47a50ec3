// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Whole registrations as callers have them: from prepared clouds, from raw points, in batches. Each
// is held to the true pose before it is timed.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "adit/benchmarks/kernels/cases.hpp"
#include "adit/benchmarks/kernels/inputs.hpp"
#include "adit/benchmarks/kernels/timing.hpp"
#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/core/units.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/slam/registration/batch_aligner.hpp"
#include "adit/tools/support/random.hpp"

namespace adit::bench {
namespace {

constexpr int kBatchPoints = 60'000;  // raw, of each cloud of a batch
constexpr double kBatchInput = 0.1;   // m
constexpr size_t kBatchClouds = 8;
constexpr size_t kStalledSweeps = 60;
constexpr double kPiece = 5.0;  // ms, of a batch beside live sweeps

struct Method {
  std::string name{};
  AlignmentSettings settings{};
  std::vector<double> voxels{};  ///< m, coarse to fine
  double bound = 0.05;           ///< m, from the truth
  std::string peer{};
  int least = 0;  ///< raw points: fewer do not fill the voxels
};

Method method(const std::string& name, RegistrationMethod kind, int neighbours, double d_max,
              std::vector<double> voxels) {
  Method made{.name = name, .voxels = std::move(voxels)};
  made.settings.method = kind;
  made.settings.neighbours = neighbours;
  made.settings.d_max = d_max;
  made.settings.translation_epsilon = 1e-3;
  made.settings.rotation_epsilon = 1e-4;
  return made;
}

std::vector<Method> methods() {
  std::vector<Method> all = {
      method("vgicp", RegistrationMethod::vgicp, 1, 1.0, {1.0}),
      method("vgicp-levels", RegistrationMethod::vgicp, 7, 0.5, {2.0, 1.0, 0.5}),
      method("ndt", RegistrationMethod::ndt, 7, 1.5, {1.0}),
      method("ndt-1", RegistrationMethod::ndt, 1, 1.5, {1.0}),
      method("ndt-levels", RegistrationMethod::ndt, 7, 2.0, {3.0, 1.5}),
      method("plane", RegistrationMethod::point_to_plane, 1, 1.0, {1.0}),
      method("d2d", RegistrationMethod::ndt_to_ndt, 7, 1.5, {2.0, 1.0})};
  all[0].peer = "pcl/gicp";
  all[2].peer = "pcl/ndt";
  all.back().bound = 0.2;  // coarse by nature
  all[5].least = all[6].least = 20'000;
  return all;
}

// Two clouds made ready for a method.
struct Prepared {
  AlignmentClouds clouds;
  SurfaceCloud source;
  AlignmentTarget target;
  std::unique_ptr<AlignmentTarget> source_map;  ///< for NDT to NDT alone

  Prepared(engine::Context& context, const PreprocessConfig& config,
           const test::AlignmentCase& scene, const Method& method)
      : clouds(context, config), source(clouds.make_cloud(scene.source)) {
    const SurfaceCloud cloud = clouds.make_cloud(scene.target);
    target = clouds.make_target(cloud, method.settings.method, method.voxels);
    if (method.settings.method == RegistrationMethod::ndt_to_ndt) {
      source_map = std::make_unique<AlignmentTarget>(
          clouds.make_target(source, method.settings.method, method.voxels));
    }
  }

  AlignmentPair pair(const Eigen::Isometry3d& start) const {
    return {.source = &source,
            .source_map = source_map.get(),
            .target = &target,
            .T_target_source = start};
  }
};

PreprocessConfig config_of(const test::AlignmentCase& scene) {
  PreprocessConfig config;
  config.r_input = scene.preprocess.r_input;
  config.c_min = scene.preprocess.c_min;
  config.c_max = scene.preprocess.c_max;
  config.beam_spacing = scene.preprocess.beam_spacing;
  return config;
}

// What a result is held to: the truth where it is known, else only its own status.
void judge(Work& work, const RegistrationResult& result, const Method& method, Bench& bench,
           int points) {
  work.figures["iterations"] = result.iterations;
  if (bench.knows_truth()) {
    const Eigen::Isometry3d error =
        bench.alignment(points).T_target_source.inverse() * result.T_target_source;
    work.figures["error mm"] = 1e3 * error.translation().norm();
    work.figures["error deg"] = kDegreesPerRadian * rotation_angle(error.linear());
    work.verified_by = "true pose";
    if (!(error.translation().norm() < method.bound)) {
      work.problem =
          "the pose is " + std::to_string(1e3 * error.translation().norm()) + " mm from the truth";
    }
  } else {
    work.verified_by = "its own status alone: the truth is not known";
  }
  if (!is_usable(result.status)) {
    work.problem = "it ended as " + std::string(to_string(result.status));
  }
}

Work align(Bench& bench, int points, const Method& method) {
  const test::AlignmentCase& scene = bench.alignment(points);
  const auto prepared =
      std::make_shared<Prepared>(bench.context(), config_of(scene), scene, method);
  const auto aligner = std::make_shared<BatchAligner>(bench.context(), method.settings);
  const Eigen::Isometry3d start = bench.start(points);
  Work work{.items = prepared->source.size};
  judge(work, aligner->align(std::vector{prepared->pair(start)}).front(), method, bench, points);
  work.run = [prepared, aligner, start] {
    return time_on_host([&] { aligner->align(std::vector{prepared->pair(start)}); });
  };
  return work;
}

// From two raw clouds to a pose.
Work pipeline(Bench& bench, int points, const Method& method) {
  const test::AlignmentCase& scene = bench.alignment(points);
  struct State {
    AlignmentClouds clouds;
    BatchAligner aligner;
    RegistrationResult result{};
  };
  const auto state =
      std::make_shared<State>(State{.clouds = AlignmentClouds(bench.context(), config_of(scene)),
                                    .aligner = BatchAligner(bench.context(), method.settings)});
  const Eigen::Isometry3d start = bench.start(points);
  const auto all = [state, &scene, method, start] {
    const SurfaceCloud target_cloud = state->clouds.make_cloud(scene.target);
    const AlignmentTarget target =
        state->clouds.make_target(target_cloud, method.settings.method, method.voxels);
    const SurfaceCloud source = state->clouds.make_cloud(scene.source);
    const AlignmentPair pair{.source = &source, .target = &target, .T_target_source = start};
    state->result = state->aligner.align(std::vector{pair}).front();
  };
  all();
  Work work{.items = scene.source.size() + scene.target.size()};
  judge(work, state->result, method, bench, points);
  work.run = [all] { return time_on_host(all); };
  return work;
}

struct Batch {
  std::vector<std::unique_ptr<Prepared>> submaps;
  std::unique_ptr<BatchAligner> aligner;
  std::vector<AlignmentPair> pairs;
};

// Submaps as loop closing has them: 34 000 points each, from guesses up to 0.3 m and 2
// degrees off.
std::shared_ptr<Batch> make_batch(Bench& bench, int pairs, const Method& method) {
  const test::AlignmentCase& scene = bench.alignment(kBatchPoints);
  PreprocessConfig config = config_of(scene);
  config.r_input = kBatchInput;
  const auto state = std::make_shared<Batch>();
  for (size_t i = 0; i < std::min<size_t>(static_cast<size_t>(pairs), kBatchClouds); ++i) {
    state->submaps.push_back(std::make_unique<Prepared>(bench.context(), config, scene, method));
  }
  state->aligner = std::make_unique<BatchAligner>(bench.context(), method.settings);
  Random random(1);
  for (int i = 0; i < pairs; ++i) {
    Vector6d offset;
    for (int k = 0; k < 6; ++k) {
      offset[k] = random.uniform(-1.0, 1.0) * (k < 3 ? 0.17 : 0.02);
    }
    state->pairs.push_back(state->submaps[static_cast<size_t>(i) % state->submaps.size()]->pair(
        retract(scene.T_target_source, offset)));
  }
  return state;
}

Work batch(Bench& bench, int pairs, const Method& method) {
  const test::AlignmentCase& scene = bench.alignment(kBatchPoints);
  const std::shared_ptr<Batch> state = make_batch(bench, pairs, method);
  Work work{.verified_by = bench.knows_truth() ? "true pose of each" : "their own status alone",
            .items = static_cast<uint64_t>(pairs)};
  int wrong = 0;
  double iterations = 0.0;
  for (const RegistrationResult& result : state->aligner->align(state->pairs)) {
    const Eigen::Vector3d off =
        (scene.T_target_source.inverse() * result.T_target_source).translation();
    wrong +=
        is_usable(result.status) && (!bench.knows_truth() || off.norm() < method.bound) ? 0 : 1;
    iterations += result.iterations;
  }
  if (wrong > 0) {
    work.problem =
        std::to_string(wrong) + " of " + std::to_string(pairs) + " pairs did not end at the truth";
  }
  work.figures["iterations"] = iterations / pairs;
  work.figures["points a pair"] = state->submaps.front()->source.size;
  work.run = [state] { return time_on_host([&] { state->aligner->align(state->pairs); }); };
  return work;
}

// A drive along a street, twice over the same sweeps: alone, and each sweep just behind a piece of
// a batch, as a loop search leaves them. How much later a sweep is done for that is its stall.
Work beside(Bench& bench, int pairs, const Method& method) {
  const std::shared_ptr<Batch> batch = make_batch(bench, pairs, method);
  const test::World world = test::make_street(60.0);
  std::vector<Sweep> sweeps;
  for (const StampedPose& pose : test::steady_drive(kStalledSweeps, test::twist(0.8, 0.01))) {
    Sweep& sweep = sweeps.emplace_back();
    sweep.stamp = pose.stamp;
    sweep.points = test::scan(world, pose, {.beams = 64, .columns = 1024}).points;
  }
  Config config;
  config.imu.use = false;
  const auto drive = [&](double piece) {
    Odometry odometry(bench.context(), config);
    std::optional<BatchAlignment> under_way;
    std::vector<double> times;
    for (const Sweep& sweep : sweeps) {
      if (piece > 0.0) {
        if (!under_way || under_way->done()) {
          under_way.emplace(batch->aligner->begin(batch->pairs));
        }
        under_way->submit(piece);
      }
      times.push_back(time_on_host([&] { static_cast<void>(odometry.step(sweep)); }).host_ms);
      if (under_way) {
        under_way->wait();
      }
    }
    return times;
  };
  Work work{.verified_by = "see batch/" + method.name, .items = static_cast<uint64_t>(pairs)};
  static_cast<void>(drive(kPiece));  // drivers compile at the first dispatch
  const std::vector<double> alone = drive(0.0);
  const auto stalls = [&](double piece) {
    std::vector<double> later = drive(piece);
    for (size_t i = 0; i < later.size(); ++i) {
      later[i] -= alone[i];
    }
    return later;
  };
  const std::vector<double> cut = stalls(kPiece);
  const std::vector<double> whole = stalls(std::numeric_limits<double>::infinity());
  work.figures = {{"sweep ms", spread_of(alone).median},
                  {"stall ms", spread_of(cut).median},
                  {"longest ms", std::ranges::max(cut)},
                  {"uncut ms", spread_of(whole).median},
                  {"uncut longest ms", std::ranges::max(whole)}};
  work.run = [batch] {
    return time_on_host([&] {
      BatchAlignment under_way = batch->aligner->begin(batch->pairs);
      while (!under_way.done()) {
        under_way.submit(kPiece);
        under_way.wait();
      }
    });
  };
  return work;
}

}  // namespace

std::vector<Case> registration_cases() {
  std::vector<Case> cases;
  for (const Method& m : methods()) {
    cases.push_back({.name = "align/" + m.name,
                     .kind = CaseKind::registration,
                     .peer = m.peer,
                     .least = m.least,
                     .make = [m](Bench& b, int n) { return align(b, n, m); }});
  }
  for (const Method& m : methods()) {
    if (m.name == "vgicp" || m.name == "ndt") {
      cases.push_back({.name = "pipeline/" + m.name,
                       .kind = CaseKind::registration,
                       .make = [m](Bench& b, int n) { return pipeline(b, n, m); }});
    }
    if (m.name == "vgicp" || m.name == "ndt" || m.name == "d2d") {
      cases.push_back({.name = "batch/" + m.name,
                       .kind = CaseKind::batch,
                       .item = "pair",
                       .make = [m](Bench& b, int n) { return batch(b, n, m); }});
    }
  }
  cases.push_back({.name = "beside/vgicp",
                   .kind = CaseKind::batch,
                   .item = "pair",
                   .make = [](Bench& b, int n) { return beside(b, n, methods().front()); }});
  return cases;
}

}  // namespace adit::bench
