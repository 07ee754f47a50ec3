// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// One linearisation of every method, number of neighbours and robust kernel, on the device and by
// its twin: what tests verify, and benchmarks before they time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "adit/benchmarks/reference/registration.hpp"
#include "adit/benchmarks/verify/device_runs.hpp"
#include "adit/benchmarks/verify/verify.hpp"

namespace adit::test {

inline constexpr double kMethodVoxel = 1.0;  ///< m
inline constexpr engine::FinishSettings kMethodGaussians = {
    .min_points = 6, .least_ratio = 0.01, .least_sigma = 0.01};

struct MethodCase {
  std::string name;
  reference::Objective objective;
};

/// With NDT's score for voxels of 1 m and 55 % outliers (Magnusson 2009).
MethodCase method_case(std::string name, uint32_t method, uint32_t neighbours,
                       uint32_t robust = gpu::kNoRobust, bool drop_back_faces = false);
std::vector<MethodCase> method_cases();

/// The map of a cloud as a method reads it, and decoded.
VoxelMapRun method_target(engine::Context& context, uint32_t method,
                          const std::vector<gpu::uvec4>& cloud);
reference::FinishedMap decode_target(uint32_t method, const VoxelMapRun& map);

/// A cloud as a method's source: its points, or its Gaussians (three uvec4 each).
std::vector<gpu::uvec4> method_source(engine::Context& context, uint32_t method,
                                      const std::vector<gpu::uvec4>& cloud);

/// An alignment as the objective says.
AlignmentRun method_run(engine::Context& context, const engine::RegistrationKernels& kernels,
                        const DeviceCloud& source, const VoxelMapRun& target,
                        const reference::Objective& objective);

/// The sums at a pose over the items that float32 and double put into the same voxel and on the
/// same side of every threshold: all but a few in a thousand.
struct MethodEvaluation {
  gpu::RegistrationState state{};
  reference::FullSystem device{};
  std::vector<reference::SourceItem> items{};
  reference::FinishedMap target{};
  reference::FullSystem twin{};
  reference::System device_step{};  ///< what the first step was solved from
  reference::System twin_step{};
};
MethodEvaluation evaluate_method(engine::Context& context, const std::vector<gpu::uvec4>& cloud,
                                 const engine::RegistrationKernels& kernels,
                                 const VoxelMapRun& target, const reference::Objective& objective,
                                 const Eigen::Isometry3d& pose);

/// Fractions of the natural scale of each sum: float32 places a point 60 m away within 4e-6 m, and
/// the inverse of a covariance of condition 100 loses 1e-5 of itself; VGICP's, of condition 1000,
/// 1e-4.
inline constexpr double kMethodBound = 3e-4;
Verdict verify_method(const MethodEvaluation& evaluation);

}  // namespace adit::test
