// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "adit/slam/core/types.hpp"

namespace adit {

inline bool is_finite(const Point& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// The sensor has seen something there: drivers write NaN or the origin where it has not.
inline bool is_return(const Point& p) {
  return is_finite(p) && (p.x != 0.0F || p.y != 0.0F || p.z != 0.0F);
}

}  // namespace adit
