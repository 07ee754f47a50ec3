// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The Point Cloud Library on the clouds of tests/kernels/cases.hpp: VoxelGrid, NormalEstimation and
// GICP, each with the settings nearest to ours. One thread, as these classes are; building of
// search trees included, as ours includes the building of tables.
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/pcl_config.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/search/kdtree.h>

#include "benchmarks/peers.hpp"
#include "tests/kernels/alignment_scene.hpp"
#include "tests/kernels/cases.hpp"
#include "tests/reference/downsample.hpp"

namespace adit::bench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Clock = std::chrono::steady_clock;

Cloud::Ptr valid_points(const std::vector<Point>& raw, const engine::PreprocessSettings& settings) {
  auto cloud = std::make_shared<Cloud>();
  for (const Point& point : raw) {
    if (reference::is_valid(point, settings)) {
      cloud->push_back({point.x, point.y, point.z});
    }
  }
  return cloud;
}

Cloud::Ptr downsampled(const Cloud::Ptr& cloud, double cell) {
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  const auto leaf = static_cast<float>(cell);
  grid.setLeafSize(leaf, leaf, leaf);
  grid.setInputCloud(cloud);
  auto result = std::make_shared<Cloud>();
  grid.filter(*result);
  return result;
}

template <class Work>
void time_on_host(benchmark::State& state, size_t points, Work&& work) {
  double total = 0.0;
  for ([[maybe_unused]] auto iteration : state) {
    const Clock::time_point begin = Clock::now();
    work();
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    state.SetIterationTime(seconds);
    total += seconds;
  }
  state.counters["points"] = static_cast<double>(points);
  state.counters["ns_a_point"] =
      1e9 * total / static_cast<double>(state.iterations()) / static_cast<double>(points);
}

void voxel_grid(benchmark::State& state, int points) {
  const test::SweepCase sweep = test::street_sweep(points);
  const Cloud::Ptr cloud = valid_points(sweep.raw, sweep.settings);
  time_on_host(state, sweep.raw.size(),
               [&] { benchmark::DoNotOptimize(downsampled(cloud, sweep.settings.r_input)); });
}

void normal_estimation(benchmark::State& state, int points) {
  const test::SweepCase sweep = test::street_sweep(points);
  const Cloud::Ptr cloud =
      downsampled(valid_points(sweep.raw, sweep.settings), sweep.settings.r_input);
  time_on_host(state, cloud->size(), [&] {
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(cloud);
    estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
    estimation.setKSearch(10);
    pcl::PointCloud<pcl::Normal> normals;
    estimation.compute(normals);
    benchmark::DoNotOptimize(normals.data());
  });
}

void gicp(benchmark::State& state, int points) {
  const test::AlignmentCase alignment = test::street_alignment(points);
  const auto prepared = [&](const std::vector<Point>& raw) {
    return downsampled(valid_points(raw, alignment.preprocess), alignment.preprocess.r_input);
  };
  const Cloud::Ptr target = prepared(alignment.target);
  const Cloud::Ptr source = prepared(alignment.source);
  const Eigen::Isometry3d start = retract(alignment.T_target_source, test::offsets().back().second);
  Eigen::Isometry3d found = start;
  time_on_host(state, source->size(), [&] {
    pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> registration;
    registration.setInputSource(source);
    registration.setInputTarget(target);
    registration.setMaxCorrespondenceDistance(alignment.settings.d_max);
    registration.setMaximumIterations(static_cast<int>(alignment.settings.max_iterations));
    Cloud aligned;
    registration.align(aligned, start.matrix().cast<float>());
    found.matrix() = registration.getFinalTransformation().cast<double>();
  });
  state.counters["mm_from_truth"] =
      1e3 * (found.translation() - alignment.T_target_source.translation()).norm();
}

}  // namespace

std::string register_peers() {
  const std::vector<std::pair<std::string, void (*)(benchmark::State&, int)>> peers = {
      {"pcl_voxel_grid", voxel_grid},
      {"pcl_normal_estimation", normal_estimation},
      {"pcl_gicp", gicp}};
  for (const auto& [name, run] : peers) {
    for (const int points : test::kTimedSizes) {
      benchmark::RegisterBenchmark((name + "/" + std::to_string(points)).c_str(), run, points)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
  return "PCL " PCL_VERSION_PRETTY;
}

}  // namespace adit::bench
