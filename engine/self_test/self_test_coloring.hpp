// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The self-test's cases of colours out of images: a wall and a ball before a camera, points before,
// on and behind them, and sightings that do not agree.
#pragma once

#include <vector>

#include "adit/engine/self_test/self_test.hpp"

namespace adit::engine {

/// Runs the kernels in submissions of their own. Distances within 0.1 mm, weights within 0.01 %;
/// which points are seen, and their colours, exactly.
std::vector<SelfTestCase> test_coloring(Context& context);

}  // namespace adit::engine
