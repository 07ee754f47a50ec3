// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace adit {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kStandardGravity = 9.80665;  // m/s²
inline constexpr double kDegree = kPi / 180.0;       // rad
inline constexpr double kDegreesPerRadian = 180.0 / kPi;

}  // namespace adit
