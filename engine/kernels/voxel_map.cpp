// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernels/voxel_map.hpp"

#include <algorithm>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/texels.hpp"

namespace adit::engine {

VoxelMapKernels::VoxelMapKernels(Context& context, VoxelContent content)
    : shape_(launch_shape(context.device())),
      texels_(reads_texels(context.device())),
      add_(context, "voxel_map_add",
           {{0, shape_.local_size},
            {2, texels_ ? 1U : 0U},
            {3, content == VoxelContent::moments ? 1U : 0U}}),
      finish_(context, "voxel_map_finish",
              {{0, shape_.local_size},
               {2, texels_ ? 1U : 0U},
               {3, content == VoxelContent::moments ? gpu::kGaussians : gpu::kPlanes}}) {}

void VoxelMapKernels::record_clear(Recorder& recorder, const VoxelMapView& map) const {
  recorder.fill(map.table, gpu::kFree);
  recorder.fill(map.counters, 0);
  recorder.barrier();
}

void VoxelMapKernels::record_add(Recorder& recorder, const VoxelMapView& map, Slice surface_cloud,
                                 uint32_t count, const gpu::mat3x4& T_map_cloud) const {
  record(recorder, map, surface_cloud, count, T_map_cloud, 1);
}

void VoxelMapKernels::record_remove(Recorder& recorder, const VoxelMapView& map,
                                    Slice surface_cloud, uint32_t count,
                                    const gpu::mat3x4& T_map_cloud) const {
  record(recorder, map, surface_cloud, count, T_map_cloud, 0xffffffffU);
}

void VoxelMapKernels::record(Recorder& recorder, const VoxelMapView& map, Slice surface_cloud,
                             uint32_t count, const gpu::mat3x4& T_map_cloud, uint32_t sign) const {
  if (count == 0) {
    return;
  }
  recorder.dispatch(add_, shape_.groups,
                    gpu::VoxelMapAddPush{T_map_cloud, static_cast<float>(1.0 / map.voxel_size),
                                         map.slots() - 1, count, sign},
                    {surface_cloud, map.table, map.counters, texel_slice(surface_cloud, texels_)});
}

void VoxelMapKernels::record_finish(Recorder& recorder, const VoxelMapView& map,
                                    const FinishSettings& settings, Slice finished) const {
  constexpr uint32_t kRounds = 128;  // per slot: Jacobi rotations and the loops within
  recorder.dispatch(
      finish_, std::max(shape_.groups, least_groups(map.slots(), kRounds, shape_.local_size)),
      gpu::VoxelMapFinishPush{
          .cell = static_cast<float>(map.voxel_size),
          .slots = map.slots(),
          .min_points = settings.min_points,
          .least_ratio = static_cast<float>(settings.least_ratio),
          .least_squared = static_cast<float>(settings.least_sigma * settings.least_sigma)},
      {map.table, finished, texel_slice(map.table, texels_)});
}

}  // namespace adit::engine
