// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where something has seen that there is nothing: of two submaps the strongest sign that they are
// of different places that look alike (docs/theory/loops.md), of the sweeps of one that a thing in
// it has moved (docs/theory/mapping.md).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "adit/slam/submaps/keyframe_submap.hpp"

namespace adit {

/// How far a submap or a sweep sees in each direction from its origin, in pixels of two degrees: as
/// far as the nearest of its points there and in the pixels around.
class RangeImage {
 public:
  /// Of its points without the flag.
  explicit RangeImage(const KeyframeSubmap& submap);
  /// Of a sweep, its lidar's axes.
  explicit RangeImage(std::span<const Point> cloud);

  enum class Sight {
    unknown,      ///< no points in that direction
    as_seen,      ///< about as far as what is seen there
    hidden,       ///< behind that
    seen_through  ///< what is seen there is farther: the sight goes past the point
  };
  /// What is seen at a point in the same frame.
  Sight at(const Eigen::Vector3d& point) const;

 private:
  RangeImage();
  void add(const Eigen::Vector3d& point);

  std::vector<float> nearest_;  ///< m; infinite: none
};

/// The sweeps of a submap as range images, at most so many: of more, those that are evenly spread.
class SweepSights {
 public:
  void add(uint32_t sweep, std::span<const Point> cloud);
  void clear();

  /// For each of the points of the submap: at least two sweeps see through it, and more than see
  /// it, so that it was not there all the time. `sweeps` are the submap's, in whose frame the
  /// points are.
  std::vector<bool> see_through(std::span<const Eigen::Vector3d> points,
                                std::span<const SubmapSweep> sweeps) const;

 private:
  struct Seen {
    uint32_t sweep = 0;
    RangeImage image;
  };
  std::vector<Seen> seen_;
  uint32_t stride_ = 1;  ///< of sweeps that are kept
};

/// Share of a submap's points that another one sees through, which `seen_by` is the image of. Of
/// those in directions that it sees something in; none where these are fewer than a tenth of all.
double seen_through(const RangeImage& seen_by, const KeyframeSubmap& submap,
                    const Eigen::Isometry3d& T_by_submap);

}  // namespace adit
