// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/kernels/free_space.hpp"

#include <algorithm>

#include "adit/engine/context.hpp"

namespace adit::engine {
namespace {

// Loops a point of the hits, and a sample of a ray: in a table at a load of one half, a probe or
// four.
constexpr uint64_t kRoundsAPoint = 7 * 4;
constexpr uint64_t kRoundsASample = 4;

}  // namespace

FreeSpaceVotes::FreeSpaceVotes(Context& context)
    : shape_(launch_shape(context.device())),
      hits_(context, "free_space_hits", {{0, shape_.local_size}}),
      rays_(context, "free_space_rays", {{0, shape_.local_size}}) {}

void FreeSpaceVotes::record_votes(Recorder& recorder, const Slice& voxels,
                                  const SpaceRays& rays) const {
  const gpu::SpacePush push{
      .begin = rays.begin,
      .ray_count = rays.count,
      .submap = rays.submap,
      .table_mask = static_cast<uint32_t>(voxels.bytes / sizeof(gpu::SpaceVoxel)) - 1};
  const auto groups = [&](uint64_t rounds) {
    return std::max(std::min(shape_.groups, hits_.groups_for(rays.count)),
                    least_groups(rays.count, rounds, shape_.local_size));
  };
  const Scope scope = recorder.scope("free space");
  recorder.dispatch(hits_, groups(kRoundsAPoint), push, {rays.rays, voxels});
  recorder.barrier();
  recorder.dispatch(rays_, groups(kRoundsASample * rays.most_samples), push, {rays.rays, voxels});
  recorder.barrier();
}

}  // namespace adit::engine
