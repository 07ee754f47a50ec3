// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "adit/tools/simulator/mesh.hpp"

namespace adit {

/// Red, green, blue.
using SurfaceColor = std::array<uint8_t, 3>;

/// What a camera sees where there is no surface.
inline constexpr SurfaceColor kColorOfSky{158, 196, 236};

/// The colour of a surface at a position (m) of the frame that the surface is fixed in. It is the
/// material's colour times a smooth pattern with features of 0.5 m, of each channel by itself, and
/// finer ones of 0.15 m; light does not change it. Another seed, another pattern. The same bits on
/// every machine.
SurfaceColor surface_color(Material material, const Eigen::Vector3d& position, uint64_t seed);

}  // namespace adit
