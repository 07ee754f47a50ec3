// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernels/preprocess.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "adit/engine/context.hpp"
#include "adit/engine/kernels/texels.hpp"
#include "adit/shaders/shared/gaussian_cell.h"

namespace adit::engine {
namespace {

// (0, 0, 0) is no return and never kept, whatever c_min is.
float smallest_squared(double c_min) {
  return std::max(static_cast<float>(c_min * c_min), std::numeric_limits<float>::min());
}

// Where the parts of the scratch are, for a capacity in points.
struct Layout {
  Slice cells;
  Slice run_counts;
  Slice run_heads;
  Slice firsts;
  Slice thread_counts;
  Slice group_counts;
  Slice surfaces;
  uint32_t cell_mask;
  uint32_t surface_mask;
  uint64_t bytes;
};

// A raw point claims a cell at most: load 0.5 at most. A surface cell holds several points of the
// down-sampled cloud, each of which is in two; even if every raw point were alone in its voxel, the
// load would stay moderate.
Layout layout_of(uint32_t capacity, const LaunchShape& shape, Slice scratch) {
  const uint32_t cell_slots = std::bit_ceil(std::max(2 * capacity, 1024U));
  const uint32_t surface_slots = std::bit_ceil(std::max(capacity, 1024U));
  Layout layout{};
  const auto take = [&](uint64_t bytes) {
    const Slice slice{scratch.buffer, scratch.offset + layout.bytes, bytes};
    layout.bytes += align_slice(bytes);
    return slice;
  };
  layout.cells = take(uint64_t{cell_slots} * sizeof(gpu::InputCell));
  const uint64_t blocks = (capacity + shape.run - 1) / shape.run;
  layout.run_counts = take(blocks * sizeof(uint32_t));
  layout.run_heads = take(blocks * shape.run * sizeof(uint32_t));
  layout.firsts = take(blocks * shape.run * sizeof(gpu::uvec2));
  layout.thread_counts = take(uint64_t{shape.threads()} * sizeof(uint32_t));
  layout.group_counts = take(uint64_t{shape.groups} * sizeof(uint32_t));
  layout.surfaces = take(uint64_t{surface_slots} * sizeof(gpu::GaussianCell));
  layout.cell_mask = cell_slots - 1;
  layout.surface_mask = surface_slots - 1;
  return layout;
}

}  // namespace

Preprocess::Preprocess(Context& context)
    : shape_(launch_shape(context.device())),
      texels_(reads_texels(context.device())),
      insert_(context, "downsample_insert",
              {{0, shape_.local_size}, {1, shape_.run}, {2, texels_ ? 1U : 0U}}),
      count_(context, "downsample_count", {{0, shape_.local_size}, {1, shape_.run}}),
      emit_(context, "downsample_emit",
            {{0, shape_.local_size},
             {1, shape_.run},
             {2, texels_ ? 1U : 0U},
             {3, context.device().gpu_shapes ? 0U : 1U}}),
      normals_(context, "surface_normals", {{0, shape_.local_size}, {2, texels_ ? 1U : 0U}}) {}

uint64_t Preprocess::scratch_bytes(uint32_t capacity) const {
  return layout_of(capacity, shape_, {}).bytes;
}

void Preprocess::record_reset(Recorder& recorder, Slice scratch) const {
  recorder.fill(scratch, gpu::kFree);
  recorder.barrier();
}

void Preprocess::record(Recorder& recorder, const PreprocessSettings& settings,
                        const PreprocessArguments& arguments, Slice scratch) const {
  const Layout layout = layout_of(arguments.capacity, shape_, scratch);
  const uint32_t count = arguments.point_count;
  const auto cell = static_cast<float>(settings.r_input);
  const float inverse_cell = 1.0F / cell;
  const auto inverse_surface_cell = static_cast<float>(1.0 / settings.surface_cell());
  const double level_root = settings.surface_growth();
  const auto level_factor = static_cast<float>(level_root * level_root);

  recorder.fill(arguments.counters, 0);
  recorder.fill(layout.surfaces, gpu::kFree);
  recorder.barrier();
  if (count == 0) {
    return;
  }
  {
    const Scope scope = recorder.scope("downsample");
    recorder.dispatch(
        insert_, insert_.groups_for((count + shape_.run - 1) / shape_.run),
        gpu::DownsamplePush{count, layout.cell_mask, inverse_cell, smallest_squared(settings.c_min),
                            static_cast<float>(settings.c_max * settings.c_max)},
        {arguments.raw, layout.cells, layout.run_counts, layout.run_heads, arguments.counters,
         texel_slice(arguments.raw, texels_)});
    recorder.barrier();
    recorder.dispatch(count_, shape_.groups, gpu::CountPush{count},
                      {layout.run_counts, layout.run_heads, layout.cells, layout.firsts,
                       layout.thread_counts, layout.group_counts});
    recorder.barrier();
    recorder.dispatch(emit_, shape_.groups,
                      gpu::EmitPush{count, cell, inverse_cell, inverse_surface_cell, level_factor,
                                    layout.surface_mask},
                      {arguments.raw, layout.firsts, layout.cells, layout.thread_counts,
                       layout.group_counts, arguments.cloud, layout.surfaces, arguments.counters,
                       texel_slice(arguments.raw, texels_)});
    recorder.barrier();
  }
  const Scope scope = recorder.scope("surfaces");
  recorder.dispatch(normals_, shape_.groups,
                    gpu::SurfacePush{inverse_surface_cell, level_factor, layout.surface_mask},
                    {arguments.cloud, layout.surfaces, arguments.surface_cloud, arguments.counters,
                     texel_slice(arguments.cloud, texels_), texel_slice(layout.surfaces, texels_)});
}

}  // namespace adit::engine
