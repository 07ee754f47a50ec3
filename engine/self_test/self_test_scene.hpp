// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The case of the self-test: a room corner whose every result is known without running a kernel.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "adit/engine/kernels/preprocess.hpp"
#include "adit/shaders/shared/prelude.h"

namespace adit::engine {

/// One point of the down-sampled cloud as it must come out.
struct KnownPoint {
  std::array<double, 3> centroid{};  ///< m
  double intensity = 0.0;            ///< that of the first raw point in the cell
  std::array<double, 3> normal{};    ///< towards the sensor
  bool plane = false;                ///< enough neighbours for a normal; otherwise isotropic
};

struct KnownScene {
  PreprocessSettings settings;
  std::vector<gpu::vec4> raw;
  uint32_t valid_points = 0;
  std::vector<KnownPoint> cloud;  ///< in order of output
};

/// A floor and two walls, four points in each cell of a plane, in an order that returns to each
/// cell later; NaN, infinite, zero, too near and too far points in between.
KnownScene make_known_scene();

/// The pose the self-test recovers: a turn of 0.02 rad and a shift of 9 cm.
gpu::mat3x4 known_pose();

}  // namespace adit::engine
