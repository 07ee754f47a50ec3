// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What two views say of the same surfaces: by it images are balanced, and cameras aligned.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "adit/slam/coloring/view_coloring.hpp"

namespace adit {

/// A colour as logarithms of its channels: a gain is added to it.
using LogColor = Eigen::Vector3d;

/// Whether a channel's value says something: it is neither black nor saturated.
bool is_exposed(const SeenColor& seen);
LogColor log_color(const SeenColor& seen);

/// What a view shows of a surface.
struct Sighted {
  uint64_t surface = 0;  ///< its key
  std::size_t view = 0;
  LogColor color = LogColor::Zero();
};
/// By surface, then by view.
void sort_by_surface(std::vector<Sighted>& sighted);

/// Views `a` and `b` see a surface: how much brighter `b` shows it, logarithms.
struct ViewRatio {
  std::size_t a = 0;
  std::size_t b = 0;
  LogColor median = LogColor::Zero();  ///< of all surfaces that both see
  std::size_t surfaces = 0;
};

/// Two sightings of a surface, by their indices.
struct SightedPair {
  std::size_t a = 0;
  std::size_t b = 0;
};
/// Of each surface, each view with the one half of its views later: far apart, so that a chain of
/// small errors does not add up. `sighted`: sorted by surface.
std::vector<SightedPair> far_pairs(const std::vector<Sighted>& sighted);

/// By pairs of views, in their order.
std::vector<ViewRatio> ratios_of(const std::vector<Sighted>& sighted,
                                 const std::vector<SightedPair>& pairs);

/// What each view's red, green and blue are to be multiplied by, so that views agree: least squares
/// over all pairs' medians, with a prior of no gain at all, a factor of two wide. Views that share
/// no surface with others keep 1.
std::vector<std::array<float, 3>> balanced_gains(std::size_t views,
                                                 std::span<const ViewRatio> ratios);

}  // namespace adit
