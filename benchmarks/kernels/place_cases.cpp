// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Descriptions of places: one of a cloud of that size, one held against a block of the index, and
// its plan correlated with ten places.
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "adit/benchmarks/kernels/cases.hpp"
#include "adit/benchmarks/kernels/inputs.hpp"
#include "adit/benchmarks/kernels/kernel_work.hpp"
#include "adit/benchmarks/verify/places.hpp"

namespace adit::bench {
namespace {

constexpr double kPlanCell = 0.5;         // m
constexpr uint32_t kVerifiedPlaces = 32;  // of a block; all look alike but for a turn
constexpr std::size_t kJobs = 90;         // ten places at nine angles

Work describe(Bench& bench, int points) {
  const std::vector<gpu::uvec4>& cloud = bench.scene(points).source();
  const auto run = std::make_shared<test::PlaceRun>(bench.context());
  const auto points_on_device = std::make_shared<test::DeviceCloud>(bench.context(), cloud);
  run->describe(*points_on_device, kPlanCell, 0);
  Work work{.problem = first_problem(test::verify_described(
                reference::describe_place(reference::decode(cloud), kPlanCell), run->record(),
                run->block(), 0)),
            .verified_by = "double-precision twin",
            .items = cloud.size()};
  work.run = [run, points_on_device] {
    return sample_of(run->describe(*points_on_device, kPlanCell, 0), "describe place");
  };
  // Its direction 20, its sector 15, its ring and cell 10. Two atomics.
  const auto count = static_cast<double>(cloud.size());
  work.cost = {.bytes = sizeof(gpu::uvec4) * count + 2.0 * sizeof(uint32_t) * gpu::kPlaceRecord,
               .flop = 45.0 * count,
               .atomics = 2.0 * count,
               .dispatches = 1.0};
  return work;
}

/// A block full of the cloud's place.
std::shared_ptr<test::PlaceRun> full_block(Bench& bench, int points) {
  auto run = std::make_shared<test::PlaceRun>(bench.context());
  const test::DeviceCloud cloud(bench.context(), bench.scene(points).source());
  for (uint32_t place = 0; place < gpu::kBlockPlaces; ++place) {
    run->describe(cloud, kPlanCell, place);
  }
  return run;
}

Work match(Bench& bench, int points) {
  const auto run = full_block(bench, points);
  run->match(kVerifiedPlaces);
  Work work{
      .problem = first_problem(test::verify_matches(run->record(), run->block(), run->matches())),
      .verified_by = "double-precision twin, on " + std::to_string(kVerifiedPlaces) + " of them",
      .items = gpu::kBlockPlaces};
  work.run = [run] { return sample_of(run->match(gpu::kBlockPlaces), "match places"); };
  work.cost = {
      .bytes = static_cast<double>(sizeof(uint32_t)) * gpu::kPolarWords * gpu::kBlockPlaces,
      .dispatches = 1.0};
  return work;
}

Work correlate(Bench& bench, int points) {
  const auto run = full_block(bench, points);
  const std::vector<Eigen::Vector2d> cells = test::plan_centres(run->record());
  std::vector<gpu::PlanJob> jobs;
  for (std::size_t i = 0; i < kJobs; ++i) {
    const double angle = 0.02 * static_cast<double>(i);
    jobs.push_back({.cosine = static_cast<float>(std::cos(angle)),
                    .sine = static_cast<float>(std::sin(angle)),
                    .place = static_cast<uint32_t>(i / 9),
                    .unused0 = 0});
  }
  const std::vector<gpu::PlanJob> few(jobs.begin(), jobs.begin() + 3);
  run->correlate(cells, few);
  Work work{
      .problem = first_problem(test::verify_correlations(cells, few, run->block(), run->matches())),
      .verified_by = "double-precision twin, on 3 of them",
      .items = jobs.size()};
  work.run = [run, cells, jobs] {
    return sample_of(run->correlate(cells, jobs), "correlate plans");
  };
  // A cell turned and shifted at every shift: 8.
  const auto looked_up = static_cast<double>(cells.size() * jobs.size() * gpu::kShifts);
  work.cost = {.bytes = static_cast<double>(sizeof(uint32_t)) * gpu::kPlanWords * kJobs,
               .flop = 8.0 * looked_up,
               .reads = looked_up,
               .dispatches = 1.0};
  work.figures["cells"] = static_cast<double>(cells.size());
  return work;
}

}  // namespace

std::vector<Case> place_cases() {
  return {{.name = "places/describe", .make = describe},
          {.name = "places/match", .item = "place", .make = match},
          {.name = "places/correlate", .item = "plan", .make = correlate}};
}

}  // namespace adit::bench
