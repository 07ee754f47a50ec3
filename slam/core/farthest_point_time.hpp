// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace adit {

/// s. No sweep lasts an hour, and a stamp plus an hour is still a stamp: a point's time beyond is
/// none.
inline constexpr float kFarthestPointTime = 3600.0F;

}  // namespace adit
