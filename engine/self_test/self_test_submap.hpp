// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The self-test's cases of a keyframe's submap: a floor that two sensors have seen, merged, and one
// whose surfaces are seen from above and from below.
#pragma once

#include <vector>

#include "adit/engine/self_test/self_test.hpp"

namespace adit::engine {

/// Runs the kernels in submissions of their own. Counts and nearest sensors exactly, places within
/// 0.02 mm; classes exactly, normals within 0.1 degrees and towards the point's own sensor.
std::vector<SelfTestCase> test_submap(Context& context);

}  // namespace adit::engine
