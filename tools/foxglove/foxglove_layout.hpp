// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Geometry>

namespace adit {

/// What a layout is for.
struct LayoutSubject {
  Eigen::AlignedBox3d way{};  ///< about the trajectory, map, m; empty: not known
  bool has_sweeps = false;    ///< plots of /sweep
  bool has_places = false;    ///< places on the Earth: a panel with a map of it
};

/// A layout of panels as Foxglove and Lichtblick import it (JSON): the scene in 3D, plots, states,
/// the log.
std::string foxglove_layout(const LayoutSubject& subject);

}  // namespace adit
