// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The self-test's case of de-skewing: a sensor that turns by 0.1 rad and moves by 1 m in 0.1 s.
#pragma once

#include <span>
#include <vector>

#include "adit/engine/kernels/deskew.hpp"
#include "adit/engine/self_test/self_test.hpp"
#include "adit/engine/self_test/self_test_scene.hpp"

namespace adit::engine {

/// The settings of the known motion, with the scene's ranges.
DeskewSettings known_motion_settings(const KnownScene& scene);
std::vector<gpu::DeskewKnot> known_motion();
/// A time for each raw point, spread over the sweep.
std::vector<float> known_times(const KnownScene& scene);

/// Points within 0.02 mm of where they belong, others no return.
SelfTestCase check_deskew(const KnownScene& scene, std::span<const gpu::vec4> moved);

}  // namespace adit::engine
