// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernels/coloring.hpp"

#include <algorithm>

#include "adit/engine/context.hpp"

namespace adit::engine {
namespace {

// Loops a surface: a square of pixels, row by row.
constexpr uint64_t kSplatAcross = 2 * gpu::kMostSplat + 1;
constexpr uint64_t kRoundsASurface = kSplatAcross * (kSplatAcross + 1) + 1;

}  // namespace

Coloring::Coloring(Context& context)
    : shape_(launch_shape(context.device())),
      depth_(context, "view_depth", {{0, shape_.local_size}}),
      sight_(context, "view_sight", {{0, shape_.local_size}}),
      mean_(context, "view_mean", {{0, shape_.local_size}}) {}

void Coloring::record_clear(Recorder& recorder, const DepthImage& depth) const {
  recorder.fill(depth.depths, gpu::kNoDepth);
  recorder.barrier();
}

void Coloring::record_depth(Recorder& recorder, const gpu::ViewCamera& camera,
                            const DepthImage& depth, Slice surfaces, uint32_t count, float radius,
                            Slice lens, Slice rays) const {
  const gpu::DepthPush push{.camera = camera,
                            .surface_count = count,
                            .depth_width = depth.width,
                            .depth_height = depth.height,
                            .pixels = depth.pixels,
                            .radius = radius};
  const uint32_t groups =
      std::min(kMaxGroups, std::max(std::min(shape_.groups, depth_.groups_for(count)),
                                    least_groups(count, kRoundsASurface, shape_.local_size)));
  const Scope scope = recorder.scope("depth of a view");
  recorder.dispatch(depth_, groups, push, {surfaces, lens, rays, depth.depths});
}

void Coloring::record_sight(Recorder& recorder, const gpu::ViewCamera& camera,
                            const DepthImage& depth, Slice points, uint32_t count, float tolerance,
                            gpu::vec3 gain, Slice lens, Slice image, Slice sightings) const {
  const gpu::SightPush push{.camera = camera,
                            .point_count = count,
                            .depth_width = depth.width,
                            .depth_height = depth.height,
                            .pixels = depth.pixels,
                            .tolerance = tolerance,
                            .gain = gain};
  const Scope scope = recorder.scope("sightings");
  recorder.dispatch(sight_, sight_.groups_for(count), push,
                    {points, lens, depth.depths, image, sightings});
  recorder.barrier();
}

void Coloring::record_mean(Recorder& recorder, Slice sightings, uint32_t count,
                           Slice colors) const {
  const Scope scope = recorder.scope("colours");
  recorder.dispatch(mean_, mean_.groups_for(count), gpu::MeanPush{.point_count = count},
                    {sightings, colors});
}

}  // namespace adit::engine
