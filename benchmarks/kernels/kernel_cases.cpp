// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// De-skewing, down-sampling, surfaces, voxel maps and linearisations: the device time of each, and
// what each has to do at least. FLOP are counted from the shaders, a point of the usual path;
// address and integer arithmetic is not counted.
#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "adit/benchmarks/kernels/cases.hpp"
#include "adit/benchmarks/kernels/inputs.hpp"
#include "adit/benchmarks/kernels/kernel_work.hpp"
#include "adit/benchmarks/reference/deskew.hpp"
#include "adit/benchmarks/verify/free_space.hpp"
#include "adit/benchmarks/verify/registration_methods.hpp"

namespace adit::bench {
namespace {

constexpr double kPoint = sizeof(Point);
constexpr double kCell = sizeof(gpu::GaussianCell);
constexpr uint32_t kSteps = 10;       // linearisations of a submission
constexpr size_t kVerified = 50'000;  // points of a linearisation that the twin adds up as well

Sample per_run(const Sample& sample, double runs) {
  return {.device_ms = *sample.device_ms / runs,
          .wait_ms = *sample.wait_ms / runs,
          .host_ms = sample.host_ms / runs};
}

// What neighbours along a beam share: of each block of consecutive points, the runs in one cell.
double runs_of(const test::AlignmentCase& scene, uint32_t block) {
  const std::vector<Point>& raw = scene.source;
  double runs = 0.0;
  for (size_t i = 0; i < raw.size(); ++i) {
    const auto cell = [&](const Point& p) {
      const auto r = static_cast<float>(scene.preprocess.r_input);
      return std::array{std::floor(p.x / r), std::floor(p.y / r), std::floor(p.z / r)};
    };
    const bool valid = reference::is_valid(raw[i], scene.preprocess);
    const bool first = i % block == 0 || !reference::is_valid(raw[i - 1], scene.preprocess) ||
                       cell(raw[i]) != cell(raw[i - 1]);
    runs += valid && first ? 1.0 : 0.0;
  }
  return runs;
}

Work preprocess(Bench& bench, int points, const std::string& scope) {
  const test::AlignmentCase& scene = bench.alignment(points);
  const auto run =
      std::make_shared<test::PreprocessRun>(bench.context(), scene.preprocess, scene.source);
  run->run();
  const auto raw = static_cast<double>(scene.source.size());
  const auto cloud = static_cast<double>(run->counters().cloud_points);
  const double runs = runs_of(scene, engine::launch_shape(bench.context().device()).run);
  const bool surfaces = scope == "surfaces";
  Work work{.verified_by = "double-precision twin"};
  work.problem = first_problem(
      surfaces
          ? test::verify_surfaces(scene.preprocess, run->cloud(), run->surface_cloud())
          : test::verify_downsample(scene.preprocess, scene.source, run->counters(), run->cloud()));
  work.run = [run, scope] { return sample_of(run->run(), scope); };
  work.items = surfaces ? run->counters().cloud_points : scene.source.size();
  // Scaling, range and offset of a raw point: 14. A run: five additions and a claim at random
  // places; a cell: its mean, and ten additions and a claim for its surface.
  if (!surfaces) {
    work.cost = {.bytes = kPoint * (raw + cloud),
                 .flop = 14.0 * raw + 20.0 * cloud,
                 .reads = cloud,
                 .atomics = 6.0 * runs + 11.0 * cloud,
                 .dispatches = 3.0};
  }
  // Covariance 50, eigenvalues by eight Newton steps 140, eigenvector and packing 75.
  if (scope != "downsample") {
    work.cost.bytes += 2.0 * kPoint * cloud;
    work.cost.flop += 265.0 * cloud;
    work.cost.reads += cloud;
    work.cost.dispatches += 1.0;
  }
  work.figures["points left"] = cloud;
  return work;
}

Work deskew(Bench& bench, int points) {
  const std::vector<Point>& raw = bench.alignment(points).source;
  const SweepMotion motion = test::sweep_motions().back();
  const std::vector<float> times = test::spread_times(raw.size(), motion);
  const engine::DeskewSettings settings =
      test::deskew_settings(motion, bench.alignment(points).preprocess.c_min);
  const auto run = std::make_shared<test::DeskewRun>(bench.context(), settings, raw, times, motion);
  run->run();
  const std::vector<Eigen::Vector3d> twin =
      reference::deskew(raw, times, motion.T_start_lidar, settings);
  Work work{.problem = first_problem(test::verify_deskew(raw, twin, run->moved())),
            .verified_by = "double-precision twin",
            .items = raw.size()};
  work.run = [run] { return sample_of(run->run(), "deskew"); };
  // Its range 5, its place between knots 3; between the two: rotation 13 and its length 13,
  // translation 10; moved by these 33. The table of knots stays in caches.
  const auto returns = static_cast<double>(
      std::ranges::count_if(twin, [](const Eigen::Vector3d& p) { return !p.isZero(0.0); }));
  const auto count = static_cast<double>(raw.size());
  work.cost = {.bytes = (2.0 * kPoint + sizeof(float)) * count,
               .flop = 5.0 * count + 72.0 * returns,
               .dispatches = 1.0};
  work.figures["returns"] = returns;
  return work;
}

Work voxel_map_add(Bench& bench, int points) {
  const test::AlignmentScene& scene = bench.scene(points);
  const auto cloud = std::make_shared<test::DeviceCloud>(bench.context(), scene.source());
  const auto map = std::make_shared<test::VoxelMapRun>(bench.context(), test::kMethodVoxel,
                                                       scene.map().view().slots());
  // At the identity and in voxels of 1 m the arithmetic is exact: no point is left out.
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  map->add(*cloud, pose);
  reference::VoxelMap expected{.voxel_size = test::kMethodVoxel};
  expected.add(reference::decode(scene.source()), pose);
  Work work{.verified_by = "double-precision twin", .items = cloud->size()};
  work.problem = first_problem(test::verify_voxel_map(expected, map->cells()));
  work.run = [map, cloud, pose] { return sample_of(map->add(*cloud, pose), "add"); };
  work.undo = [map, cloud, pose] { map->remove(*cloud, pose); };
  map->remove(*cloud, pose);
  // Two rotations 30, offsets 9, the constraint 21. Five atomics a point, seven more a surface.
  const auto count = static_cast<double>(cloud->size());
  double surfaces = 0.0;
  for (const auto& [at, voxel] : expected.voxels) {
    surfaces += static_cast<double>(voxel.surfaces);
  }
  work.cost = {.bytes = kPoint * count + kCell * static_cast<double>(expected.voxels.size()),
               .flop = 60.0 * count,
               .atomics = 5.0 * count + 7.0 * surfaces,
               .dispatches = 1.0};
  work.figures["voxels"] = static_cast<double>(expected.voxels.size());
  return work;
}

Work voxel_map_finish(Bench& bench, int points) {
  const test::AlignmentScene& scene = bench.scene(points);
  const auto map = std::make_shared<test::VoxelMapRun>(
      test::method_target(bench.context(), gpu::kNdt, scene.source()));
  const reference::FinishedMap found = test::decode_target(gpu::kNdt, *map);
  std::map<reference::Cell, std::vector<Eigen::Vector3d>> members;
  for (const reference::SurfacePoint& point : reference::decode(scene.source())) {
    members[reference::place_of(point.p, test::kMethodVoxel).cell].push_back(point.p);
  }
  Work work{.verified_by = "double-precision twin", .items = scene.map().view().slots()};
  size_t expected = 0;
  for (const auto& [at, inside] : members) {
    if (inside.size() < test::kMethodGaussians.min_points) {
      continue;
    }
    expected += 1;
    const auto voxel = found.find(at);
    const reference::FinishedVoxel twin = reference::gaussian_of(inside, test::kMethodGaussians);
    if (voxel == found.end() || !((voxel->second.form - twin.form).norm() < 2e-4)) {
      work.problem = "a voxel's Gaussian is not the twin's";
    }
  }
  if (found.size() != expected) {
    work.problem =
        "voxels: expected " + std::to_string(expected) + ", found " + std::to_string(found.size());
  }
  work.run = [map] { return sample_of(map->finish(test::kMethodGaussians), "finish"); };
  // Twelve Jacobi rotations of 66, the covariance and its widening 110.
  work.cost = {.bytes = 2.0 * kCell * static_cast<double>(work.items),
               .flop = 900.0 * static_cast<double>(members.size()),
               .dispatches = 1.0};
  work.figures["voxels"] = static_cast<double>(members.size());
  return work;
}

// The two clouds of an alignment in their true places, as two sweeps of one submap.
std::vector<reference::CloudToMerge> two_clouds(const test::AlignmentCase& scene) {
  return {{.points = scene.target},
          {.points = scene.source, .T_submap_lidar = scene.T_target_source}};
}

Work submap_merge(Bench& bench, int points) {
  const std::vector<reference::CloudToMerge> clouds = two_clouds(bench.alignment(points));
  const double edge = 2.0 * bench.alignment(points).preprocess.r_input;
  // Of finer cells the same point's rounding is a larger share.
  const double error = 2.0 * test::kMovedPointError * std::max(1.0, 0.25 / edge);
  const reference::MergedClouds twin = reference::merge(clouds, edge, error);
  const auto slots = static_cast<uint32_t>(std::bit_ceil(2 * twin.cells.size()));
  const auto run = std::make_shared<test::SubmapMergeRun>(bench.context(), clouds, edge, slots);
  run->run();
  Work work{.problem = first_problem(test::verify_merged(twin, run->cells())),
            .verified_by = "double-precision twin",
            .items = clouds[0].points.size() + clouds[1].points.size()};
  work.run = [run] { return sample_of(run->run(), "merge"); };
  // Moved and scaled 21, its range 6, offsets 6. A claim, five sums.
  const auto count = static_cast<double>(work.items);
  work.cost = {
      .bytes = kPoint * count + sizeof(gpu::MergeCell) * static_cast<double>(twin.cells.size()),
      .flop = 33.0 * count,
      .atomics = 6.0 * count,
      .dispatches = 2.0};
  work.figures["cells"] = static_cast<double>(twin.cells.size());
  return work;
}

Work submap_surfaces(Bench& bench, int points) {
  const test::AlignmentCase& scene = bench.alignment(points);
  engine::PreprocessSettings settings = scene.preprocess;
  settings.r_input *= 2.0;
  const std::vector<reference::CloudToMerge> clouds = two_clouds(scene);
  std::vector<reference::SeenPoint> seen;
  std::vector<gpu::uvec4> cloud;
  const std::vector<Eigen::Vector3f> sensors = {Eigen::Vector3f::Zero(),
                                                scene.T_target_source.translation().cast<float>()};
  for (const auto& [at, cell] : reference::merge(clouds, settings.r_input, 0.0).cells) {
    const Eigen::Vector3d corner(static_cast<double>(at[0]), static_cast<double>(at[1]),
                                 static_cast<double>(at[2]));
    const Eigen::Vector3f p = ((corner + cell.mean) * settings.r_input).cast<float>();
    seen.push_back({.p = p, .ray = p - sensors[cell.nearest]});
    cloud.push_back({std::bit_cast<uint32_t>(p.x()), std::bit_cast<uint32_t>(p.y()),
                     std::bit_cast<uint32_t>(p.z()), cell.nearest});
  }
  const auto run =
      std::make_shared<test::SubmapSurfacesRun>(bench.context(), settings, cloud, sensors);
  run->run();
  Work work{.problem = first_problem(test::verify_surfaces(settings, seen, run->surface_cloud())),
            .verified_by = "double-precision twin",
            .items = cloud.size()};
  work.run = [run] { return sample_of(run->run(), "submap surfaces"); };
  // As the surfaces of a sweep, with the moments besides: 20, ten additions and a claim.
  const auto count = static_cast<double>(cloud.size());
  work.cost = {.bytes = 3.0 * kPoint * count,
               .flop = 285.0 * count,
               .reads = count,
               .atomics = 11.0 * count,
               .dispatches = 2.0};
  return work;
}

/// Both clouds as submaps, in the tile around the first.
Work free_space(Bench& bench, int points) {
  constexpr double kEdge = 0.25;  // m
  std::vector<PlacedSubmap> submaps;
  for (const reference::CloudToMerge& cloud : two_clouds(bench.alignment(points))) {
    submaps.push_back(test::placed_sweep(cloud.points, cloud.T_submap_lidar));
  }
  const test::FreeSpaceCase made = test::free_space_case({.across = 256}, kEdge, submaps);
  const auto run = std::make_shared<test::FreeSpaceRun>(bench.context(), made);
  run->run();
  Work work{.problem = first_problem(test::verify_votes(made, run->table())),
            .verified_by = "double-precision twin",
            .items = made.rays()};
  work.run = [run] { return sample_of(run->run(), "votes"); };
  // A point asks for seven voxels, a sample for one: 14 whole-number operations and a read each.
  const auto asked = 7.0 * static_cast<double>(made.rays()) + static_cast<double>(made.samples());
  work.cost = {.bytes = sizeof(gpu::SpaceRay) * 2.0 * static_cast<double>(made.rays()),
               .flop = 14.0 * asked,
               .reads = asked,
               .dispatches = 4.0};
  work.figures["samples"] = static_cast<double>(made.samples());
  return work;
}

struct Linearization {
  engine::RegistrationKernels kernels;
  test::DeviceCloud source;
  test::VoxelMapRun target;
  test::AlignmentRun run;

  Linearization(engine::Context& context, const reference::Objective& objective,
                const std::vector<gpu::uvec4>& cloud)
      : kernels(context, objective.options),
        source(context, test::method_source(context, objective.options.method, cloud)),
        target(test::method_target(context, objective.options.method, cloud)),
        run(test::method_run(context, kernels, source, target, objective)) {}
};

std::vector<gpu::uvec4> thinned(const std::vector<gpu::uvec4>& cloud) {
  const size_t step = (cloud.size() + kVerified - 1) / kVerified;
  std::vector<gpu::uvec4> result;
  for (size_t i = 0; i < cloud.size(); i += step) {
    result.push_back(cloud[i]);
  }
  return result;
}

// Cost of one linearisation. A point: two rotations, its direction, its place 50, its part of the
// sums 85. A match: mean, covariance and inverse 110, weight and sums 60. The assessment also adds
// up the geometry, 40, and finds each match's normal, 200, and what it holds, 80.
Cost linearization_cost(double points, double matches, double voxels, double neighbours,
                        bool assess) {
  return {.bytes = kPoint * points + kCell * voxels,
          .flop = (assess ? 260.0 : 135.0) * points + (assess ? 450.0 : 170.0) * matches,
          .reads = (assess ? 2.0 : 1.0) * neighbours * points,
          .dispatches = assess ? 2.0 : 1.0};
}

Work linearize(Bench& bench, int points, const test::MethodCase& method, bool assess) {
  const std::vector<gpu::uvec4>& cloud = bench.scene(points).source();
  const auto made = std::make_shared<Linearization>(bench.context(), method.objective, cloud);
  const Eigen::Isometry3d pose = retract(Eigen::Isometry3d::Identity(), test::offsets()[3].second);
  const std::vector<gpu::uvec4> some = thinned(cloud);
  const test::MethodEvaluation evaluation = test::evaluate_method(
      bench.context(), some, made->kernels, made->target, method.objective, pose);
  Work work{.problem = first_problem(test::verify_method(evaluation)),
            .verified_by = "double-precision twin, on " + std::to_string(evaluation.items.size()) +
                           " of them"};
  const bool gaussians = method.objective.options.method == gpu::kNdtToNdt;
  made->run.evaluate(pose);
  const gpu::RegistrationState sums = made->run.state();
  const auto voxels = static_cast<double>(evaluation.target.size());
  work.items = gaussians ? made->source.size() / 3 : made->source.size();
  // The steps are recorded one after the other, as alignments do; their limit of convergence is 0.
  work.run = [made, pose, assess] {
    return assess ? sample_of(made->run.evaluate(pose), "align")
                  : per_run(sample_of(made->run.step(pose, kSteps), "align"), kSteps);
  };
  const auto matches = static_cast<double>(sums.system[gpu::kMatchesAt]);
  work.cost = linearization_cost(static_cast<double>(work.items), matches, voxels,
                                 method.objective.options.neighbours, assess);
  work.cost.bytes += gaussians ? (kCell - kPoint) * static_cast<double>(work.items) : 0.0;
  work.figures["matches"] = matches;
  work.figures["voxels"] = voxels;
  return work;
}

}  // namespace

std::vector<Case> kernel_cases() {
  std::vector<Case> cases = {
      {.name = "deskew", .peer = "host/deskew", .make = deskew},
      {.name = "downsample",
       .peer = "pcl/voxel-grid",
       .make = [](Bench& b, int n) { return preprocess(b, n, "downsample"); }},
      {.name = "surfaces",
       .peer = "pcl/normals",
       .make = [](Bench& b, int n) { return preprocess(b, n, "surfaces"); }},
      {.name = "preprocess",
       .make = [](Bench& b, int n) { return preprocess(b, n, "preprocess"); }},
      {.name = "submap/merge", .make = submap_merge},
      {.name = "submap/surfaces", .make = submap_surfaces},
      {.name = "free-space", .item = "ray", .make = free_space},
      {.name = "voxel-map/add", .make = voxel_map_add},
      {.name = "voxel-map/finish", .item = "slot", .make = voxel_map_finish},
  };
  const auto add = [&cases](const std::string& name, uint32_t method, uint32_t neighbours,
                            uint32_t robust = gpu::kNoRobust, bool assess = false) {
    const test::MethodCase made = test::method_case(name, method, neighbours, robust);
    cases.push_back(
        {.name = name,
         .item = method == gpu::kNdtToNdt ? "slot" : "point",
         .peer = name == "linearize/vgicp" ? "host/linearize" : "",
         .make = [made, assess](Bench& b, int n) { return linearize(b, n, made, assess); }});
  };
  add("linearize/vgicp", gpu::kVgicp, 1);
  add("linearize/vgicp-7", gpu::kVgicp, 7);
  add("linearize/vgicp-27", gpu::kVgicp, 27);
  add("linearize/vgicp-huber", gpu::kVgicp, 1, gpu::kHuber);
  add("linearize/ndt", gpu::kNdt, 1);
  add("linearize/ndt-7", gpu::kNdt, 7);
  add("linearize/plane", gpu::kPointToPlane, 1);
  add("linearize/d2d-7", gpu::kNdtToNdt, 7);
  add("assess/vgicp", gpu::kVgicp, 1, gpu::kNoRobust, true);
  return cases;
}

}  // namespace adit::bench
