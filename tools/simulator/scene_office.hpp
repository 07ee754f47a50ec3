// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the office shares with other buildings. Metres.
#pragma once

#include "adit/tools/simulator/mesh.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {

inline constexpr double kOfficeLength = 44.0;   ///< of a storey, along x from 0
inline constexpr double kOfficeCorridor = 1.2;  ///< half the width of its corridor, around y = 0
inline constexpr double kOfficeOuter = 7.7;     ///< from there to the outer walls
inline constexpr double kOfficeCeiling = 3.0;   ///< above the floor

/// Adds a storey whose floor is at z = `floor`, open at both ends: a corridor with eight rooms on
/// either side.
void add_office_storey(Mesh& mesh, double floor, Random& random);

}  // namespace adit
