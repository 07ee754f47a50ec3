// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "adit/slam/core/types.hpp"

namespace adit {

/// The angle between neighbouring beams of a range sensor, rad, the wider of the two directions, as
/// a sweep shows it: at an elevation drawn at random from those that a sector of one degree of
/// azimuth covers, the gap between the returns above and below it; of that the median. Between
/// 0.002 and 0.2; points in the sensor's frame, whose axes do not matter: azimuth and elevation are
/// those about spin_axis(). None of fewer than 1000 returns.
std::optional<double> measured_beam_spacing(std::span<const Point> points);

/// A sixtieth of the range that nine in ten of these points stay below: voxels for which near
/// surfaces are still surfaces. (Not of the median: on open ground half of the points are near.) m,
/// between 0.05 and kUsualInput; none of fewer than 1000 returns.
std::optional<double> measured_voxel_size(std::span<const Point> points);

}  // namespace adit
