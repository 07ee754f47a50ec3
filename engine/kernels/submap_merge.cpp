// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernels/submap_merge.hpp"

#include <algorithm>
#include <bit>

#include "adit/engine/context.hpp"
#include "adit/shaders/shared/gaussian_cell.h"

namespace adit::engine {
namespace {

// A cell of the surfaces holds several points as a rule; even where it does not, the load is one
// half.
uint32_t surface_slots(uint32_t points) {
  return std::bit_ceil(std::max(2 * points, 1024U));
}

}  // namespace

SubmapMerge::SubmapMerge(Context& context)
    : shape_(launch_shape(context.device())),
      merge_(context, "submap_merge", {{0, shape_.local_size}}),
      cells_(context, "submap_surface_cells", {{0, shape_.local_size}}),
      surfaces_(context, "submap_surfaces", {{0, shape_.local_size}}) {}

void SubmapMerge::record_clear(Recorder& recorder, const MergeView& view) const {
  recorder.fill(view.table, gpu::kFree);
  recorder.fill(view.counters, 0);
  recorder.barrier();
}

void SubmapMerge::record_add(Recorder& recorder, const MergeView& view,
                             const MergeCloud& cloud) const {
  recorder.dispatch(merge_, std::min(shape_.groups, merge_.groups_for(cloud.count)),
                    gpu::MergePush{.pose = cloud.T_submap_lidar,
                                   .inverse_cell = static_cast<float>(1.0 / view.voxel_size),
                                   .table_mask = view.slots() - 1,
                                   .begin = cloud.begin,
                                   .point_count = cloud.count,
                                   .sweep = cloud.sweep},
                    {cloud.points, view.table, view.counters});
}

uint64_t SubmapMerge::surface_scratch_bytes(uint32_t points) {
  return uint64_t{surface_slots(points)} * sizeof(gpu::GaussianCell);
}

void SubmapMerge::record_surfaces(Recorder& recorder, const PreprocessSettings& settings,
                                  const SubmapSurfaceArguments& arguments, Slice scratch) const {
  const double growth = settings.surface_growth();
  const gpu::SubmapSurfacePush push{
      .point_count = arguments.count,
      .inverse_surface_cell = static_cast<float>(1.0 / settings.surface_cell()),
      .level_factor = static_cast<float>(growth * growth),
      .surface_mask = surface_slots(arguments.count) - 1};
  const Slice cells = scratch.sub(0, surface_scratch_bytes(arguments.count));
  recorder.fill(cells, gpu::kFree);
  recorder.barrier();
  const Scope scope = recorder.scope("submap surfaces");
  const uint32_t groups = std::min(shape_.groups, cells_.groups_for(arguments.count));
  recorder.dispatch(cells_, groups, push, {arguments.points, arguments.sensors, cells});
  recorder.barrier();
  recorder.dispatch(surfaces_, groups, push,
                    {arguments.points, arguments.sensors, cells, arguments.surface_cloud});
}

}  // namespace adit::engine
