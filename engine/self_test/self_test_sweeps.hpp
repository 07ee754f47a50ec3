// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adit/engine/self_test/self_test.hpp"

namespace adit::engine {

/// Everything a sweep goes through, from raw points to the directions that its alignment holds, and
/// the engine's own kernels.
std::vector<SelfTestCase> test_sweeps(Context& context);

}  // namespace adit::engine
