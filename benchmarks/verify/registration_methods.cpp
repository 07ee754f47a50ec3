// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/verify/registration_methods.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace adit::test {
namespace {

using reference::FinishedMap;
using reference::FullSystem;
using reference::Objective;
using reference::SourceItem;

constexpr uint32_t kMethodSlots = 1U << 15U;
constexpr double kMethodMargin = 2e-4;  // voxels, as in AlignmentScene
constexpr double kD1 = -2.217225;
constexpr double kD2 = 0.433123;

bool has_moments(uint32_t method) {
  return method == gpu::kNdt || method == gpu::kNdtToNdt;
}

// Points that float32 and double put into the same voxel and on the same side of d_max of all
// their neighbours, and that neither takes for a back face alone.
bool is_certain(const SourceItem& item, const FinishedMap& target, const Eigen::Isometry3d& pose,
                const Objective& objective) {
  const Eigen::Vector3d q = pose * item.p;
  const reference::Place place = reference::place_of(q, 1.0);
  const Eigen::Vector3d ray = (q - objective.viewpoint).normalized();
  if (!place.certain(kMethodMargin) ||
      std::abs(ray.dot(pose.linear() * item.normal) - 0.174) < kMethodMargin) {
    return false;
  }
  const auto cells = reference::neighbours_of(place.cell, objective.options.neighbours);
  return std::ranges::none_of(cells, [&](const reference::Cell& cell) {
    const auto found = target.find(cell);
    return found != target.end() &&
           std::abs((found->second.mean - q).norm() - objective.d_max) < kMethodMargin;
  });
}

FullSystem sums_of(const gpu::RegistrationState& state) {
  FullSystem sums;
  size_t k = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      sums.system.hessian(i, j) = sums.system.hessian(j, i) =
          static_cast<double>(state.system[k++]);
    }
  }
  for (int i = 0; i < 6; ++i) {
    sums.system.gradient(i) = static_cast<double>(state.system[k++]);
  }
  sums.system.cost = static_cast<double>(state.system[gpu::kCostAt]);
  sums.system.squared_distance = static_cast<double>(state.system[gpu::kSquaredAt]);
  sums.system.inliers = static_cast<int64_t>(state.system[gpu::kInliersAt]);
  sums.matches = static_cast<int64_t>(state.system[gpu::kMatchesAt]);
  const float* g = state.system + gpu::kGeometryAt;
  const Eigen::Vector3d ra(g[1], g[2], g[3]);
  Eigen::Matrix3d outer;
  outer << g[4], g[5], g[6], g[5], g[7], g[8], g[6], g[8], g[9];
  sums.isotropic.topLeftCorner<3, 3>() = static_cast<double>(g[0]) * Eigen::Matrix3d::Identity();
  sums.isotropic.topRightCorner<3, 3>() = -skew(ra);
  sums.isotropic.bottomLeftCorner<3, 3>() = skew(ra);
  sums.isotropic.bottomRightCorner<3, 3>() = outer.trace() * Eigen::Matrix3d::Identity() - outer;
  for (int i = 0; i < 6; ++i) {
    sums.isotropic_gradient(i) = -static_cast<double>(g[10 + i]);
  }
  return sums;
}

SourceItem item_of(const gpu::uvec4& packed) {
  const reference::SurfacePoint surface = reference::decode(packed);
  const bool plane = reference::is_plane(surface.kind);
  return {.p = surface.p,
          .form = surface.constraint(),
          .normal = plane ? surface.direction : Eigen::Vector3d::Zero(),
          .facing = reference::facing_normal(surface)};
}

}  // namespace

MethodCase method_case(std::string name, uint32_t method, uint32_t neighbours, uint32_t robust,
                       bool drop_back_faces) {
  MethodCase test{.name = std::move(name), .objective = {}};
  test.objective.options = {.method = method,
                            .neighbours = neighbours,
                            .robust = robust,
                            .drop_back_faces = drop_back_faces};
  test.objective.d_max = 1.3;
  test.objective.robust_width = 0.4;
  if (has_moments(method)) {
    test.objective.score_weight = -kD1 * kD2;
    test.objective.score_exponent = 0.5 * kD2;
  }
  return test;
}

std::vector<MethodCase> method_cases() {
  return {method_case("VGICP, 7 neighbours", gpu::kVgicp, 7),
          method_case("VGICP, 27 neighbours, no back faces", gpu::kVgicp, 27, gpu::kNoRobust, true),
          method_case("VGICP, Huber", gpu::kVgicp, 1, gpu::kHuber),
          method_case("VGICP, Cauchy", gpu::kVgicp, 1, gpu::kCauchy),
          method_case("VGICP, Geman-McClure", gpu::kVgicp, 1, gpu::kGemanMcClure),
          method_case("NDT", gpu::kNdt, 1),
          method_case("NDT, 7 neighbours", gpu::kNdt, 7),
          method_case("point to plane", gpu::kPointToPlane, 1),
          method_case("NDT to NDT, 7 neighbours", gpu::kNdtToNdt, 7)};
}

VoxelMapRun method_target(engine::Context& context, uint32_t method,
                          const std::vector<gpu::uvec4>& cloud) {
  VoxelMapRun map(
      context, kMethodVoxel, kMethodSlots,
      has_moments(method) ? engine::VoxelContent::moments : engine::VoxelContent::surfaces);
  map.add(DeviceCloud(context, cloud), Eigen::Isometry3d::Identity());
  if (has_moments(method)) {
    map.finish(kMethodGaussians);
  } else if (method == gpu::kPointToPlane) {
    map.finish({.min_points = 1});
  }
  return map;
}

FinishedMap decode_target(uint32_t method, const VoxelMapRun& map) {
  return method == gpu::kVgicp ? reference::finished(reference::decode(map.cells(), kMethodVoxel))
                               : reference::decode_finished(map.target_cells());
}

std::vector<gpu::uvec4> method_source(engine::Context& context, uint32_t method,
                                      const std::vector<gpu::uvec4>& cloud) {
  if (method != gpu::kNdtToNdt) {
    return cloud;
  }
  const std::vector<gpu::GaussianCell> cells = method_target(context, method, cloud).target_cells();
  const auto* words = reinterpret_cast<const gpu::uvec4*>(cells.data());
  return {words, words + 3 * cells.size()};
}

AlignmentRun method_run(engine::Context& context, const engine::RegistrationKernels& kernels,
                        const DeviceCloud& source, const VoxelMapRun& target,
                        const Objective& objective) {
  return {context,
          kernels,
          source,
          target,
          {.d_max = objective.d_max},
          {.robust_width = objective.robust_width,
           .viewpoint = objective.viewpoint,
           .score_weight = objective.score_weight,
           .score_exponent = objective.score_exponent}};
}

MethodEvaluation evaluate_method(engine::Context& context, const std::vector<gpu::uvec4>& cloud,
                                 const engine::RegistrationKernels& kernels,
                                 const VoxelMapRun& target, const Objective& objective,
                                 const Eigen::Isometry3d& pose) {
  const uint32_t method = objective.options.method;
  MethodEvaluation evaluation;
  evaluation.target = decode_target(method, target);
  const std::vector<gpu::uvec4> source = method_source(context, method, cloud);
  std::vector<gpu::uvec4> kept;
  const size_t words = method == gpu::kNdtToNdt ? 3 : 1;
  for (size_t at = 0; at < source.size(); at += words) {
    std::vector<SourceItem> items;
    if (method == gpu::kNdtToNdt) {
      const auto* cell = reinterpret_cast<const gpu::GaussianCell*>(&source[at]);
      for (const auto& [where, voxel] : reference::decode_finished(std::span(cell, 1))) {
        items.push_back({.p = voxel.mean, .form = voxel.form});
      }
    } else {
      items.push_back(item_of(source[at]));
    }
    if (!items.empty() && is_certain(items.front(), evaluation.target, pose, objective)) {
      evaluation.items.push_back(items.front());
      kept.insert(kept.end(), &source[at], &source[at] + words);
    }
  }
  const DeviceCloud certain(context, kept);
  AlignmentRun run = method_run(context, kernels, certain, target, objective);
  run.evaluate(pose);
  evaluation.state = run.state();
  evaluation.device = sums_of(evaluation.state);
  evaluation.twin =
      reference::linearize(evaluation.items, evaluation.target, kMethodVoxel, pose, objective);
  run.step(pose, 1);
  evaluation.device_step = system_of(run.state());
  Objective stepping = objective;
  stepping.stepping = true;
  evaluation.twin_step =
      reference::linearize(evaluation.items, evaluation.target, kMethodVoxel, pose, stepping)
          .system;
  return evaluation;
}

Verdict verify_method(const MethodEvaluation& evaluation) {
  const FullSystem& device = evaluation.device;
  const FullSystem& twin = evaluation.twin;
  Verdict verdict;
  const auto compare = [&](const std::string& what, double error) {
    verdict.worst[what + " error, fraction of scale"] = error;
    if (!(error <= kMethodBound)) {
      verdict.problems.push_back(what + " is off by " + std::to_string(error) + " of its scale");
    }
  };
  const auto count = [&](const std::string& what, int64_t found, int64_t expected) {
    if (found != expected) {
      verdict.problems.push_back(what + ": expected " + std::to_string(expected) + ", found " +
                                 std::to_string(found));
    }
  };
  count("points matched", device.system.inliers, twin.system.inliers);
  count("matches", device.matches, twin.matches);
  const Vector6d unit = twin.system.hessian.diagonal().cwiseSqrt();
  const Vector6d isotropic = twin.isotropic.diagonal().cwiseSqrt();
  const auto worst = [](const auto& difference, const auto& scale) {
    return difference.cwiseQuotient(scale).cwiseAbs().maxCoeff();
  };
  compare("H", worst(device.system.hessian - twin.system.hessian, unit * unit.transpose()));
  compare("g", worst(device.system.gradient - twin.system.gradient,
                     std::sqrt(twin.weighted_cost) * unit));
  compare("H of the step", worst(evaluation.device_step.hessian - evaluation.twin_step.hessian,
                                 unit * unit.transpose()));
  compare("g of the step", worst(evaluation.device_step.gradient - evaluation.twin_step.gradient,
                                 std::sqrt(twin.weighted_cost) * unit));
  compare("cost", std::abs(device.system.cost / twin.system.cost - 1.0));
  compare("squared distance",
          std::abs(device.system.squared_distance / twin.system.squared_distance - 1.0));
  compare("sum of w J^T J",
          worst(device.isotropic - twin.isotropic, isotropic * isotropic.transpose()));
  // d_max bounds each match's share of the gradient's scale.
  compare("sum of w J^T e", worst(device.isotropic_gradient - twin.isotropic_gradient,
                                  std::sqrt(twin.isotropic(0, 0)) * isotropic));
  verdict.worst["matches compared"] = static_cast<double>(twin.matches);
  return verdict;
}

}  // namespace adit::test
