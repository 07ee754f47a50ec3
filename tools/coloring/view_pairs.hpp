// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What two views say of the same surfaces: by it images are balanced, and cameras aligned.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "adit/slam/coloring/view_coloring.hpp"

namespace adit {

/// A colour as logarithms of its channels: a gain is added to it.
using LogColor = Eigen::Vector3d;

/// Whether a channel's value says something: it is neither black nor saturated.
bool is_exposed(const SeenColor& seen);
LogColor log_color(const SeenColor& seen);

/// The colours of a surface in the views that see it, views ascending.
struct SurfaceColors {
  struct One {
    std::size_t view = 0;
    LogColor color = LogColor::Zero();
  };
  std::vector<One> views{};
};

/// Views `a` and `b` see a surface: how much brighter `b` shows it, logarithms.
struct ViewRatio {
  std::size_t a = 0;
  std::size_t b = 0;
  LogColor median = LogColor::Zero();  ///< of all surfaces that both see
  std::size_t surfaces = 0;
};

/// Of each surface, each view with the one half of its views later: far apart, so that a chain of
/// small errors does not add up.
std::vector<std::pair<std::size_t, std::size_t>> far_pairs(std::size_t views);

/// By pairs of views, in their order.
std::vector<ViewRatio> ratios_of(const std::map<uint64_t, SurfaceColors>& surfaces);

/// What each view's red, green and blue are to be multiplied by, so that views agree: least squares
/// over all pairs' medians, with a prior of no gain at all, a factor of two wide. Views that share
/// no surface with others keep 1.
std::vector<std::array<float, 3>> balanced_gains(std::size_t views,
                                                 std::span<const ViewRatio> ratios);

}  // namespace adit
