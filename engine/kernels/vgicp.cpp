// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "engine/kernels/vgicp.hpp"

#include "engine/context.hpp"
#include "engine/kernels/texels.hpp"

namespace adit::engine {
namespace {

// Eigenvalues of the regularised covariances are (epsilon, 1, 1): Koide et al. and all its
// descendants.
constexpr float kPlaneEpsilon = 1e-3F;

}  // namespace

Vgicp::Vgicp(Context& context)
    : shape_(launch_shape(context.device())),
      texels_(reads_texels(context.device())),
      linearize_(context, "vgicp_linearize", {{0, shape_.local_size}, {2, texels_ ? 1U : 0U}}) {}

uint64_t Vgicp::scratch_bytes() const {
  return align_slice(uint64_t{shape_.groups} * gpu::kSystemStride * sizeof(float));
}

gpu::RegistrationStart Vgicp::start() const {
  return {.groups_x = shape_.groups,
          .groups_y = 1,
          .groups_z = 1,
          .phase = gpu::kPhaseIterate,
          .iterations = 0,
          .converged = 0,
          .failed = 0,
          .ticket = 0,
          .damping = 1.0F,
          .last_step = {},
          .unused0 = 0};
}

void Vgicp::record(Recorder& recorder, const VgicpSettings& settings,
                   const VgicpArguments& arguments, Slice scratch) const {
  const VoxelMapView& target = arguments.target;
  const gpu::LinearizePush push{
      .cell = static_cast<float>(target.voxel_size),
      .inverse_cell = static_cast<float>(1.0 / target.voxel_size),
      .table_mask = target.slots() - 1,
      .max_squared = static_cast<float>(settings.d_max * settings.d_max),
      .epsilon = kPlaneEpsilon,
      .translation_epsilon = static_cast<float>(settings.translation_epsilon),
      .rotation_epsilon = static_cast<float>(settings.rotation_epsilon),
      .max_iterations = settings.max_iterations};
  recorder.barrier();
  recorder.copy(arguments.start.sub(0, sizeof(gpu::RegistrationStart)),
                arguments.state.sub(0, sizeof(gpu::RegistrationStart)));
  recorder.barrier();
  for (uint32_t i = 0; i < settings.max_iterations + 1; ++i) {
    recorder.dispatch_indirect(
        linearize_, arguments.state, push,
        {arguments.surface_cloud, arguments.counters, target.table, scratch, arguments.state,
         texel_slice(arguments.surface_cloud, texels_), texel_slice(target.table, texels_)});
    recorder.barrier();
  }
}

}  // namespace adit::engine
