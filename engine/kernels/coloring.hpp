// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/kernels/launch.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/shaders/shared/coloring.h"

namespace adit::engine {

/// The depth image of a view, coarser than its image.
struct DepthImage {
  Slice depths;         ///< uint, bits of a distance in m; gpu::kNoDepth: nothing
  uint32_t width = 0;   ///< pixels
  uint32_t height = 0;  ///< pixels
  float pixels = 1.0F;  ///< of the image, in one of its
};

/// Colours of points out of images (docs/theory/coloring.md). None of the calls allocates, submits
/// or waits.
class Coloring {
 public:
  explicit Coloring(Context& context);

  /// Nothing is seen in the depth image. Ends with a barrier.
  void record_clear(Recorder& recorder, const DepthImage& depth) const;

  /// Adds `count` surfaces (gpu::ViewSurface) to the depth image. `lens` holds gpu::kLensSteps + 1
  /// radii, `rays` a direction of unit length (three floats) a pixel of the depth image. Without a
  /// barrier: surfaces may come in any order.
  void record_depth(Recorder& recorder, const gpu::ViewCamera& camera, const DepthImage& depth,
                    Slice surfaces, uint32_t count, float radius, Slice lens, Slice rays) const;

  /// What the image (a uint a pixel, red in the low byte), its channels times `gain`, shows of
  /// `count` points (three floats) joins their gpu::kMostSightings sightings each. Ends with a
  /// barrier.
  void record_sight(Recorder& recorder, const gpu::ViewCamera& camera, const DepthImage& depth,
                    Slice points, uint32_t count, float tolerance, gpu::vec3 gain, Slice lens,
                    Slice image, Slice sightings) const;

  /// A colour (uint) a point.
  void record_mean(Recorder& recorder, Slice sightings, uint32_t count, Slice colors) const;

 private:
  LaunchShape shape_;
  Kernel depth_;
  Kernel sight_;
  Kernel mean_;
};

}  // namespace adit::engine
