// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Quantiles of the chi-squared distribution, by degrees of freedom (0 to 6).
#pragma once

#include <array>

namespace adit {

inline constexpr std::array kChiSquared95 = {0.0, 3.841, 5.991, 7.815, 9.488, 11.070, 12.592};
inline constexpr std::array kChiSquared999 = {0.0, 10.828, 13.816, 16.266, 18.467, 20.515, 22.458};

}  // namespace adit
