// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The static transforms of the first seconds of a recording, in their order; empty where it
/// has none. Damage is passed over: whoever reads on reports it.
std::vector<StaticTransform> static_transforms(const Recording& recording);

}  // namespace adit
