// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Straight walls in a thin slice of a cloud. Points are summed up in small cells, by the side that
// their surface faces: the two faces of a wall are two lines, however thin it is.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

namespace adit {

/// What a cell of a slice holds of surfaces that face about the same way, and sums of such cells.
struct SliceFace {
  double points = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();      ///< m, of places
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();  ///< m^2, of their outer products
  Eigen::Vector2d normals = Eigen::Vector2d::Zero();  ///< of unit vectors

  /// `normal` of any length; zero: none.
  void add(const Eigen::Vector2d& place, const Eigen::Vector2d& normal);
  SliceFace& operator+=(const SliceFace& other);
};

/// A slice as sums. The order of the points matters for the last bits alone; a map's is fixed.
class SliceCells {
 public:
  /// m, the edge of a cell: finer than a wall is thick.
  static constexpr double kEdge = 0.05;

  /// `normal`: the surface's direction within the slice, of any length, towards the sensor; zero
  /// where it has none.
  void add(const Eigen::Vector2d& place, const Eigen::Vector2d& normal);

  /// Row, column, and which way the surface faces.
  using Key = std::array<int64_t, 3>;
  static constexpr int64_t kWays = 8;  ///< the last number of a key is below; kWays itself: none

  bool empty() const { return faces_.empty(); }
  const std::map<Key, SliceFace>& faces() const { return faces_; }
  /// m, what sums are counted from: UTM's numbers would cost them their digits.
  const Eigen::Vector2d& origin() const { return origin_; }

 private:
  std::map<Key, SliceFace> faces_;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
};

/// A straight piece of wall. The side that was seen is to the left of from -> to.
struct WallSegment {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();  ///< m
  Eigen::Vector2d to = Eigen::Vector2d::Zero();    ///< m
  double spread = 0.0;                             ///< m, standard deviation of points about it
  double points = 0.0;                             ///< how many it is fitted to
};

struct WallLines {
  std::vector<WallSegment> walls{};
  std::vector<Eigen::Vector2d> rest{};  ///< m, middles of cells whose points lie on no wall
  double noise = 0.0;                   ///< m, typical spread of points about their surface
};

/// Lines by total least squares, grown cell by cell as long as points lie within three standard
/// deviations of them, which the points themselves tell. Gaps of more than 0.3 m, doors among them,
/// stay open. Ends that meet in a corner are put there.
WallLines find_walls(const SliceCells& cells);

}  // namespace adit
