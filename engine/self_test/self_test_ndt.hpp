// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adit/engine/self_test/self_test.hpp"

namespace adit::engine {

/// Maps of Gaussians and NDT: the known cloud finds its known pose.
std::vector<SelfTestCase> test_ndt(Context& context);

}  // namespace adit::engine
