// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <Eigen/Core>

#include "adit/slam/core/types.hpp"

namespace adit {

/// The axis (unit, of either sign) that a range sensor's pattern is laid out about, in the axes
/// that its points are in, whatever these are. Neighbouring returns of a sensor that spins lie
/// along circles about its axis, or along meridians; so do those of an image's rows and columns. It
/// is z where half of the returns lie so about z, and of patterns without an axis.
Eigen::Vector3d spin_axis(std::span<const Point> points);

}  // namespace adit
