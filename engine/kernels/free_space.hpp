// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/kernels/launch.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/shaders/shared/free_space.h"

namespace adit::engine {

/// The rays of a submap through a tile.
struct SpaceRays {
  Slice rays;          ///< gpu::SpaceRay
  uint32_t begin = 0;  ///< first of the submap's in the slice
  uint32_t count = 0;
  uint32_t submap = 0;        ///< its number, from 1, another one for each
  uint32_t most_samples = 0;  ///< of a ray
};

/// What submaps say of the voxels of a tile: in how many of them something is there, and the rays
/// of how many go through that see nothing there. `voxels` is a hash table of gpu::SpaceVoxel by
/// mix32() of the key with linear probing, a power of two long, which the host fills to a half at
/// most; only the counts change.
class FreeSpaceVotes {
 public:
  explicit FreeSpaceVotes(Context& context);

  /// Ends with a barrier: submaps vote one after the other.
  void record_votes(Recorder& recorder, const Slice& voxels, const SpaceRays& rays) const;

 private:
  LaunchShape shape_;
  Kernel hits_;
  Kernel rays_;
};

}  // namespace adit::engine
