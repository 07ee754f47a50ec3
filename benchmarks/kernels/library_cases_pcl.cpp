// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The Point Cloud Library on the same clouds, each with the settings nearest to ours. VoxelGrid,
// GICP and NDT have one thread, the normals all; building of search trees and maps is included
// where PCL does it in the same call.
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/pcl_config.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/ndt.h>
#include <pcl/search/kdtree.h>

#include "adit/benchmarks/kernels/cases.hpp"
#include "adit/benchmarks/kernels/inputs.hpp"
#include "adit/benchmarks/kernels/timing.hpp"
#include "adit/benchmarks/reference/downsample.hpp"
#include "adit/slam/core/units.hpp"

namespace adit::bench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr int kMostPoints = 120'000;  // more would take PCL minutes

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

std::function<Sample()> timed(std::function<void()> run) {
  return [run = std::move(run)] { return time_on_host(run); };
}

Work voxel_grid(Bench& bench, int points) {
  const test::AlignmentCase& scene = bench.alignment(points);
  const Cloud::Ptr cloud = valid_points(scene.source, scene.preprocess);
  const double cell = scene.preprocess.r_input;
  Work work{.verified_by = "nothing: it is a peer", .items = scene.source.size()};
  work.figures["points left"] = static_cast<double>(downsampled(cloud, cell)->size());
  work.run = timed([cloud, cell] { downsampled(cloud, cell); });
  return work;
}

Work normals(Bench& bench, int points) {
  const test::AlignmentCase& scene = bench.alignment(points);
  const Cloud::Ptr cloud =
      downsampled(valid_points(scene.source, scene.preprocess), scene.preprocess.r_input);
  Work work{.verified_by = "nothing: it is a peer", .items = cloud->size()};
  work.run = timed([cloud] {
    pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(cloud);
    estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
    estimation.setKSearch(10);
    pcl::PointCloud<pcl::Normal> found;
    estimation.compute(found);
  });
  return work;
}

using Registration = pcl::Registration<pcl::PointXYZ, pcl::PointXYZ>;

std::shared_ptr<Registration> make_gicp() {
  auto gicp =
      std::make_shared<pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>>();
  gicp->setMaxCorrespondenceDistance(1.0);
  gicp->setMaximumIterations(30);
  return gicp;
}

std::shared_ptr<Registration> make_ndt() {
  auto ndt = std::make_shared<pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>>();
  ndt->setResolution(1.0F);
  ndt->setTransformationEpsilon(1e-3);
  ndt->setMaximumIterations(30);
  return ndt;
}

Work align(Bench& bench, int points, std::shared_ptr<Registration> (*make)()) {
  const test::AlignmentCase& scene = bench.alignment(points);
  const auto prepared = [&](const std::vector<Point>& raw) {
    return downsampled(valid_points(raw, scene.preprocess), scene.preprocess.r_input);
  };
  const Cloud::Ptr target = prepared(scene.target);
  const Cloud::Ptr source = prepared(scene.source);
  const Eigen::Matrix4f start = bench.start(points).matrix().cast<float>();
  const auto found = std::make_shared<Eigen::Matrix4f>();
  const auto run = [=] {
    const std::shared_ptr<Registration> registration = make();
    registration->setInputSource(source);
    registration->setInputTarget(target);
    Cloud aligned;
    registration->align(aligned, start);
    *found = registration->getFinalTransformation();
  };
  run();
  Work work{.verified_by = "nothing: it is a peer", .items = source->size()};
  if (bench.knows_truth()) {
    Eigen::Isometry3d pose;
    pose.matrix() = found->cast<double>();
    const Eigen::Isometry3d error = scene.T_target_source.inverse() * pose;
    work.figures["error mm"] = 1e3 * error.translation().norm();
    work.figures["error deg"] = Eigen::AngleAxisd(error.linear()).angle() * kDegreesPerRadian;
  }
  work.run = timed(run);
  return work;
}

}  // namespace

std::vector<Case> library_cases() {
  const auto peer = [](const std::string& name, std::function<Work(Bench&, int)> make) {
    return Case{.name = "pcl/" + name,
                .kind = CaseKind::peer,
                .most = kMostPoints,
                .make = std::move(make)};
  };
  return {peer("voxel-grid", voxel_grid), peer("normals", normals),
          peer("gicp", [](Bench& b, int n) { return align(b, n, make_gicp); }),
          peer("ndt", [](Bench& b, int n) { return align(b, n, make_ndt); })};
}

}  // namespace adit::bench
