// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the self-test expects of each kernel, with the tolerances. All arithmetic of the host is in
// double.
#pragma once

#include <span>
#include <string_view>

#include "adit/engine/self_test/self_test.hpp"
#include "adit/engine/self_test/self_test_scene.hpp"
#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/shaders/shared/preprocess.h"
#include "adit/shaders/shared/registration.h"

namespace adit::engine {

/// A voxel map after the cloud was added and after it was taken out again.
struct FoundVoxelMap {
  std::span<const gpu::GaussianCell> cells;
  std::span<const gpu::GaussianCell> emptied;
  gpu::VoxelMapCounters counters;
  double voxel_size = 0.0;  ///< m
};

/// Valid points exactly; no point lost.
struct FoundAlignment {
  const gpu::RegistrationState& state;
  const gpu::RegistrationHeader& header;
  const gpu::RegistrationProgress& progress;
};

SelfTestCase check_insert(const KnownScene& scene, const gpu::SweepCounters& counters);
/// Points of the down-sampled cloud exactly.
SelfTestCase check_count(const KnownScene& scene, const gpu::SweepCounters& counters);
/// Order and intensities exactly, centroids within 0.02 mm.
SelfTestCase check_emit(const KnownScene& scene, std::span<const gpu::vec4> cloud);
/// Classes exactly, normals within 0.1 degrees and towards the sensor.
SelfTestCase check_normals(const KnownScene& scene, std::span<const gpu::uvec4> surface_cloud,
                           const gpu::SweepCounters& counters);
/// Every point in one voxel, centre of mass within 0.1 mm, traces of the constraints; all sums zero
/// after removal.
SelfTestCase check_voxel_map(const KnownScene& scene, const FoundVoxelMap& map);
/// Converged to known_pose() within 0.5 mm and 0.2 mrad, with at least 95 % of the points matched.
SelfTestCase check_finished_map(const KnownScene& scene,
                                std::span<const gpu::GaussianCell> finished);
SelfTestCase check_alignment(const KnownScene& scene, std::string_view method,
                             const FoundAlignment& found);
SelfTestCase check_directions(const FoundAlignment& found);

}  // namespace adit::engine
