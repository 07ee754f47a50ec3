// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The parts of the self-test, none of which needs another's results: each may run on a context of
// its own.
#pragma once

#include <array>

#include "adit/engine/self_test/self_test_coloring.hpp"
#include "adit/engine/self_test/self_test_ndt.hpp"
#include "adit/engine/self_test/self_test_places.hpp"
#include "adit/engine/self_test/self_test_submap.hpp"
#include "adit/engine/self_test/self_test_sweeps.hpp"

namespace adit::engine {

using SelfTestPart = std::vector<SelfTestCase> (*)(Context&);

/// What takes longest to compile first.
inline constexpr std::array<SelfTestPart, 5> kSelfTestParts = {test_sweeps, test_ndt, test_submap,
                                                               test_places, test_coloring};

}  // namespace adit::engine
