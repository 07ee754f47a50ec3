// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a submap has seen that there is nothing: the strongest sign that two submaps are of
// different places that look alike (docs/theory/loops.md).
#pragma once

#include <vector>

#include "adit/slam/mapping/keyframe_submap.hpp"

namespace adit {

/// How far a submap sees in each direction from its origin, in pixels of two degrees: as far as the
/// nearest of its points there and in the pixels around.
class RangeImage {
 public:
  explicit RangeImage(const KeyframeSubmap& submap);

  enum class Sight {
    unknown,      ///< no points in that direction
    as_seen,      ///< about as far as the submap's own points, or behind them
    seen_through  ///< the submap sees farther, past the point
  };
  /// What the submap sees at a point in its frame.
  Sight at(const Eigen::Vector3d& point) const;

 private:
  std::vector<float> nearest_;  ///< m; infinite: none
};

/// Share of a submap's points that another one sees through, which `seen_by` is the image of. Of
/// those in directions that it sees something in; none where these are fewer than a tenth of all.
double seen_through(const RangeImage& seen_by, const KeyframeSubmap& submap,
                    const Eigen::Isometry3d& T_by_submap);

}  // namespace adit
