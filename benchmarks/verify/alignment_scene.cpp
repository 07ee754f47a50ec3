// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/verify/alignment_scene.hpp"

#include <bit>
#include <cmath>

#include "adit/tools/support/random.hpp"

namespace adit::test {
namespace {

constexpr uint32_t kSlots = 1U << 15U;
constexpr double kMargin = 2e-4;  // voxels

std::vector<gpu::uvec4> preprocess(engine::Context& context,
                                   const engine::PreprocessSettings& settings,
                                   const std::vector<Point>& raw) {
  PreprocessRun run(context, settings, raw);
  run.run();
  return run.surface_cloud();
}

}  // namespace

AlignmentScene::AlignmentScene(engine::Context& context, const AlignmentCase& alignment)
    : AlignmentScene(context, preprocess(context, alignment.preprocess, alignment.target),
                     preprocess(context, alignment.preprocess, alignment.source),
                     alignment.T_target_source, alignment.voxel_size, alignment.settings) {}

AlignmentScene::AlignmentScene(engine::Context& context, const std::vector<gpu::uvec4>& target,
                               std::vector<gpu::uvec4> source,
                               const Eigen::Isometry3d& T_target_source, double voxel_size,
                               const reference::AlignmentSettings& settings)
    : source_(std::move(source)),
      T_target_source_(T_target_source),
      settings_(settings),
      kernels_(context, {}),
      map_(context, voxel_size, kSlots) {
  map_.add(DeviceCloud(context, target), Eigen::Isometry3d::Identity());
  target_ = reference::decode(map_.cells(), voxel_size);
}

std::vector<gpu::uvec4> AlignmentScene::certain_source(const Eigen::Isometry3d& pose,
                                                       double d_max) const {
  std::vector<gpu::uvec4> certain;
  for (const gpu::uvec4& packed : source_) {
    const reference::SurfacePoint point = reference::decode(packed);
    const Eigen::Vector3d q = pose * point.p;
    const Eigen::Vector3d normal = pose.linear() * reference::facing_normal(point);
    const double facing = std::abs(normal.dot(reference::facing_axis()));
    if (std::abs(facing - double{gpu::kUnclearFacing}) < kMargin) {
      continue;
    }
    const reference::Place place = reference::place_of(q, target_.voxel_size);
    if (!place.certain(kMargin)) {
      continue;
    }
    const auto voxel = target_.voxels.find(place.cell);
    if (voxel != target_.voxels.end()) {
      const double distance = (voxel->second.mean(place.cell, target_.voxel_size) - q).norm();
      const double parallel = normal.dot(voxel->second.constraint() * normal);
      if (std::abs(distance - d_max) < kMargin * target_.voxel_size ||
          std::abs(parallel - 0.8) < kMargin) {
        continue;
      }
    }
    certain.push_back(packed);
  }
  return certain;
}

std::vector<gpu::uvec4> with_random_surfaces(const std::vector<Point>& points, uint64_t seed) {
  Random random(seed);
  const auto bits = [&random](double end) {
    return static_cast<uint32_t>(random.uniform(0.0, end));
  };
  std::vector<gpu::uvec4> cloud;
  for (const Point& p : points) {
    // The class, and the 15-bit coordinates of the octahedral map.
    const uint32_t kind = bits(4.0);
    const uint32_t u = bits(32767.0);
    const uint32_t v = bits(32767.0);
    cloud.push_back({std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y),
                     std::bit_cast<uint32_t>(p.z), (kind << 30U) | (u << 15U) | v});
  }
  return cloud;
}

AlignmentScene random_surfaces_scene(engine::Context& context) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(0.4, -0.3, 0.2));
  pose.rotate(Eigen::AngleAxisd(0.9, Eigen::Vector3d(0.2, -0.4, 0.8).normalized()));
  std::vector<Point> moved;
  for (const Point& p : room(6000, 92)) {
    const Eigen::Vector3d q = pose.inverse() * Eigen::Vector3d(p.x, p.y, p.z);
    moved.push_back({static_cast<float>(q.x()), static_cast<float>(q.y()),
                     static_cast<float>(q.z()), p.intensity});
  }
  return {
      context,
      with_random_surfaces(room(9000, 91), 93),
      with_random_surfaces(moved, 94),
      pose,
      0.6,
      {.d_max = 0.6, .translation_epsilon = 1e-4, .rotation_epsilon = 2e-5, .max_iterations = 30}};
}

std::vector<std::pair<std::string, Vector6d>> offsets() {
  const auto offset = [](double x, double y, double z, double roll, double pitch, double yaw) {
    Vector6d xi;
    xi << x, y, z, roll, pitch, yaw;
    return xi;
  };
  return {{"no offset", Vector6d::Zero()},
          {"1 mm and 0.1 mrad", offset(6e-4, -6e-4, 5e-4, 6e-5, -5e-5, 6e-5)},
          {"0.3 m ahead", offset(0.3, 0.0, 0.0, 0.0, 0.0, 0.0)},
          {"0.3 m aside and up", offset(0.0, 0.25, 0.15, 0.0, 0.0, 0.0)},
          {"2 degrees of yaw", offset(0.0, 0.0, 0.0, 0.0, 0.0, 0.035)},
          {"2 degrees of roll and pitch", offset(0.0, 0.0, 0.0, -0.025, 0.025, 0.0)},
          {"0.4 m and 3 degrees", offset(-0.3, 0.2, 0.15, 0.025, -0.02, -0.04)}};
}

}  // namespace adit::test
