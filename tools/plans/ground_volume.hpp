// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Volumes between two grounds of one place, or between a ground and a plane, with their errors.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "adit/tools/plans/ground_surface.hpp"

namespace adit {

/// Ground with its small gaps closed.
struct ClosedGround {
  GroundHeights heights;
  std::set<GroundHeights::Index> closed{};  ///< cells that were not seen
};
/// Gaps of up to kGroundGap cells between two that were seen are interpolated, along rows, columns
/// and diagonals, where a slope of 45 degrees and a step of kGroundStep reach across.
ClosedGround closed_gaps(const GroundHeights& ground);

/// Two grounds of one place, in cells of one size. Where several storeys lie above each other,
/// those of a cell are compared that are nearest to each other.
struct GroundPair {
  ClosedGround before;
  ClosedGround after;
};
GroundPair ground_pair(const GroundLevels& before, const GroundLevels& after, double size);

/// Cells of both, less those of the other, m.
GroundHeights difference_of(const GroundHeights& after, const GroundHeights& before);

/// What differences of heights are where nothing has changed.
class StableGround {
 public:
  /// Means over square patches of one size.
  struct Patches {
    double area = 0.0;      ///< m2, of one
    double variance = 0.0;  ///< m2, of their means
  };

  double offset = 0.0;  ///< m, mean difference
  double spread = 0.0;  ///< m, standard deviation of a cell about it
  double area = 0.0;    ///< m2
  std::vector<Patches> patches{};

  /// m, standard error of the mean difference over so many square metres. Errors of neighbouring
  /// cells are correlated, so it comes from the means of patches: of all their sizes the one that
  /// gives the largest error counts.
  double error_of_mean(double area) const;
};
/// The ground that has not changed is the largest share of these differences that agree: those
/// around the shortest interval that holds half of them (Rousseeuw and Leroy 1988). Nothing where
/// there are too few of them, or where that half spreads by more than kGroundStep: it is no stable
/// ground then.
std::optional<StableGround> stable_ground(const GroundHeights& differences);

/// A volume with its standard error.
struct MeasuredVolume {
  double volume = 0.0;  ///< m3
  double error = 0.0;   ///< m3, one standard deviation; of what StableGround knows
  double area = 0.0;    ///< m2
};
struct GroundVolume {
  MeasuredVolume fill{};  ///< of changed cells that are higher now
  MeasuredVolume cut{};   ///< of those that are lower; positive
  MeasuredVolume net{};   ///< fill less cut
  double rest = 0.0;      ///< m3, of cells that count as unchanged; in none of the others
  double compared = 0.0;  ///< m2
};
struct VolumeRule {
  std::optional<StableGround> stable{};  ///< none: all cells count, and errors are the offset's
  double offset = 0.0;                   ///< m, that is taken off all differences
  double offset_error = 0.0;             ///< m, its standard error
  double square = 1.0;                   ///< m2 on the ground, of a cell
  double least_area = 0.0;               ///< m2, of what has changed at one place
};
/// Of the differences of cells that `is_wanted`. A cell has changed where it differs by three times
/// the spread of stable ground, or of kLeastSpread. Cells up to two from it count with it, whatever
/// they are: the foot of a heap is among them, and their noise has no sign.
GroundVolume ground_volume(const GroundHeights& differences, const VolumeRule& rule,
                           const std::function<bool(const GroundHeights::Index&)>& is_wanted);
/// m: three of it are 3 cm, the accuracy that data sheets of range sensors state. Stable ground may
/// spread by less, since errors are alike over metres.
inline constexpr double kLeastSpread = 0.01;

/// A plane: height at (x, y) is that at `middle` and its slopes' part.
struct GroundPlane {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double height = 0.0;  ///< m
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();

  double at(const Eigen::Vector2d& place) const { return height + slope.dot(place - middle); }
};
/// Through most of the heights, by Tukey's weights. Nothing where they lie on a line.
std::optional<GroundPlane> plane_through(const GroundHeights& heights);

}  // namespace adit
