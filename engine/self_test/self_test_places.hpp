// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The self-test's cases of places: posts around the sensor, described, found again after a turn,
// and their plan after a shift.
#pragma once

#include <vector>

#include "adit/engine/self_test/self_test.hpp"

namespace adit::engine {

/// Runs the kernels in submissions of their own. Everything is expected exactly.
std::vector<SelfTestCase> test_places(Context& context);

}  // namespace adit::engine
