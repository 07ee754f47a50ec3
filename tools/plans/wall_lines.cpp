// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/wall_lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "adit/tools/plans/wall_corners.hpp"

namespace adit {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// m. Half of the narrowest passage that building codes know (0.6 m): no door is closed by a line.
constexpr double kWidestGap = 0.3;
// m, around a cell, for the first guess of a line: a dozen cells, and less than a narrow pillar.
constexpr double kFirstReach = 0.3;
// m: pillars and the faces of short walls are wall; what is shorter is drawn as points.
constexpr double kShortest = 0.3;
// Normals of points scatter by some 10 degrees (one sigma), cells have several points.
constexpr double kSameWay = 0.9;  // cosine
constexpr double kDeviations = 3.0;
// m: what is spread evenly over the cells that a first line is fitted to has 0.04 m. Three
// deviations of this are half of a door.
constexpr double kMostNoise = 0.03;
// Sizes that a line must be fitted to: cells are 0.05 m, so that half of 0.3 m must be covered.
constexpr double kCovered = 0.5;  // share of a line's length that has points
// Of the points on a line those that face its way: nearly all of a wall's, one in seven of a
// bush's.
constexpr double kAgreeing = 0.5;
constexpr int kRefits = 3;
// m: submaps merge points in cells of 0.2 to 0.3 m, and with them the faces of walls that are
// thinner.
constexpr double kMerged = 0.2;

/// A line through points by total least squares.
struct FittedLine {
  Vector2d middle = Vector2d::Zero();
  Vector2d normal = Vector2d::UnitX();  ///< towards the side that was seen
  double spread = 0.0;                  ///< m, standard deviation across
  double length = 0.0;                  ///< m, along

  double off(const Vector2d& p) const { return normal.dot(p - middle); }
  Vector2d along() const { return {normal.y(), -normal.x()}; }
};

// The axes of a symmetric matrix in closed form: the same bits wherever roots are as IEEE 754 asks.
FittedLine fitted(const SliceFace& sums) {
  FittedLine line;
  line.middle = sums.sum / sums.points;
  const Matrix2d covariance = sums.squares / sums.points - line.middle * line.middle.transpose();
  const double half = 0.5 * (covariance(0, 0) - covariance(1, 1));
  const double mixed = covariance(0, 1);
  const double root = std::sqrt(half * half + mixed * mixed);
  const double mean = 0.5 * (covariance(0, 0) + covariance(1, 1));
  // Of two ways to write the long axis that which loses no digits.
  Vector2d axis = half >= 0.0 ? Vector2d(half + root, mixed) : Vector2d(mixed, root - half);
  axis = axis.norm() > 0.0 ? Vector2d(axis.normalized()) : Vector2d(Vector2d::UnitX());
  line.normal = {-axis.y(), axis.x()};
  if (line.normal.dot(sums.normals) < 0.0) {
    line.normal = -line.normal;
  }
  line.spread = std::sqrt(std::max(0.0, mean - root));
  line.length = std::sqrt(std::max(0.0, mean + root));
  return line;
}

struct Face {
  SliceCells::Key key{};
  SliceFace sums{};
  Vector2d middle = Vector2d::Zero();
  Vector2d normal = Vector2d::Zero();         ///< unit, or zero
  bool hidden = false;                        ///< close to a wall that faces the same way
  bool used = false;                          ///< on a wall
  std::optional<std::size_t> reached_from{};  ///< the last seed that did
};

class WallFinder {
 public:
  explicit WallFinder(const SliceCells& cells) : origin_(cells.origin()) {
    faces_.reserve(cells.faces().size());
    for (const auto& [key, sums] : cells.faces()) {
      Face face{.key = key, .sums = sums, .middle = sums.sum / sums.points};
      if (key[2] < SliceCells::kWays) {
        face.normal = sums.normals.normalized();
      }
      faces_.push_back(face);
    }
  }

  WallLines find() {
    const std::vector<std::size_t> seeds = measured_seeds();
    for (const std::size_t seed : seeds) {
      if (!faces_[seed].used && !faces_[seed].hidden) {
        grow(seed);
      }
    }
    join_corners(walls_, kWidestGap);
    WallLines found{.walls = walls_, .rest = rest(), .noise = noise_};
    for (WallSegment& wall : found.walls) {
      wall.from += origin_;
      wall.to += origin_;
    }
    return found;
  }

 private:
  /// Calls act(index) for faces of any way in cells within `reach` (m) of one.
  void near(const SliceCells::Key& key, double reach, const auto& act) const {
    const auto cells = static_cast<int64_t>(std::ceil(reach / SliceCells::kEdge));
    for (int64_t y = key[0] - cells; y <= key[0] + cells; ++y) {
      auto at =
          std::ranges::lower_bound(faces_, SliceCells::Key{y, key[1] - cells, 0}, {}, &Face::key);
      for (; at != faces_.end() && at->key[0] == y && at->key[1] <= key[1] + cells; ++at) {
        act(static_cast<std::size_t>(at - faces_.begin()));
      }
    }
  }

  /// A line through what faces the same way around a face.
  std::optional<SliceFace> around(std::size_t seed) const {
    SliceFace sums;
    int cells = 0;
    near(faces_[seed].key, kFirstReach, [&](std::size_t i) {
      const Face& face = faces_[i];
      // Across no further than a cell: what faces the same way may be the next cabinet.
      if (!face.used && !face.hidden && face.normal.dot(faces_[seed].normal) >= kSameWay &&
          std::abs(faces_[seed].normal.dot(face.middle - faces_[seed].middle)) <=
              1.5 * SliceCells::kEdge) {
        sums += face.sums;
        ++cells;
      }
    });
    return cells >= 3 ? std::optional(sums) : std::nullopt;
  }

  /// Faces that a line can start from, those with the most points around first; sets the noise.
  std::vector<std::size_t> measured_seeds() {
    std::vector<std::pair<double, std::size_t>> ranked;
    std::vector<std::pair<double, double>> spreads;  // and weights
    double weight = 0.0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      if (const auto sums = faces_[i].normal.isZero() ? std::nullopt : around(i)) {
        const FittedLine line = fitted(*sums);
        ranked.emplace_back(-sums->points, i);
        spreads.emplace_back(line.spread, faces_[i].sums.points);
        weight += faces_[i].sums.points;
      }
    }
    std::ranges::sort(ranked);
    std::ranges::sort(spreads);
    double below = 0.0;
    for (const auto& [spread, points] : spreads) {
      below += points;
      if (below >= 0.5 * weight) {
        noise_ = std::min(spread, kMostNoise);
        break;
      }
    }
    std::vector<std::size_t> seeds;
    for (const auto& [points, face] : ranked) {
      seeds.push_back(face);
    }
    return seeds;
  }

  /// Within three deviations; half the width of a cell's own points where these hardly scatter.
  double bound() const { return std::max(kDeviations * noise_, 0.25 * SliceCells::kEdge); }

  bool fits(const FittedLine& line, const Face& face) const {
    return std::abs(line.off(face.middle)) <= bound() && line.normal.dot(face.normal) >= kSameWay;
  }

  std::vector<std::size_t> connected(std::size_t seed, FittedLine line, SliceFace sums) {
    std::vector<std::size_t> members;
    std::vector<std::size_t> waiting = {seed};
    faces_[seed].reached_from = seed;
    while (!waiting.empty()) {
      const std::size_t at = waiting.back();
      waiting.pop_back();
      members.push_back(at);
      near(faces_[at].key, kWidestGap, [&](std::size_t i) {
        Face& face = faces_[i];
        if (face.reached_from != seed && !face.used && !face.hidden && fits(line, face)) {
          face.reached_from = seed;
          waiting.push_back(i);
          sums += face.sums;
          line = fitted(sums);
        }
      });
    }
    return members;
  }

  SliceFace sums_of(const std::vector<std::size_t>& members) const {
    SliceFace sums;
    for (const std::size_t i : members) {
      sums += faces_[i].sums;
    }
    return sums;
  }

  void grow(std::size_t seed) {
    const auto first = around(seed);
    if (!first) {
      return;
    }
    FittedLine line = fitted(*first);
    std::vector<std::size_t> members = connected(seed, line, *first);
    // What was taken in along the way need not lie on the line that came out of it.
    for (int i = 0; i < kRefits && members.size() >= 3; ++i) {
      line = fitted(sums_of(members));
      std::erase_if(members, [&](std::size_t face) { return !fits(line, faces_[face]); });
    }
    cut(line, std::move(members));
  }

  /// Adds the parts of a line that have points, without the gaps between them.
  void cut(const FittedLine& line, std::vector<std::size_t> members) {
    const auto place = [&](std::size_t i) { return line.along().dot(faces_[i].middle); };
    std::ranges::sort(members, [&](std::size_t a, std::size_t b) {
      return std::pair(place(a), a) < std::pair(place(b), b);
    });
    for (std::size_t begin = 0; begin < members.size();) {
      std::size_t end = begin + 1;
      while (end < members.size() && place(members[end]) - place(members[end - 1]) <= kWidestGap) {
        ++end;
      }
      add({members.begin() + static_cast<std::ptrdiff_t>(begin),
           members.begin() + static_cast<std::ptrdiff_t>(end)});
      begin = end;
    }
  }

  /// Points on a line that face another way than it and its other face.
  double disagreeing(const FittedLine& line, const std::vector<std::size_t>& members) const {
    std::set<std::size_t> others;
    for (const std::size_t member : members) {
      near(faces_[member].key, bound(), [&](std::size_t i) {
        if (!faces_[i].normal.isZero() && std::abs(line.off(faces_[i].middle)) <= bound() &&
            std::abs(line.normal.dot(faces_[i].normal)) < kSameWay) {
          others.insert(i);
        }
      });
    }
    double points = 0.0;
    for (const std::size_t i : others) {
      points += faces_[i].sums.points;
    }
    return points;
  }

  void add(const std::vector<std::size_t>& members) {
    if (members.size() < 3) {
      return;
    }
    const SliceFace sums = sums_of(members);
    const FittedLine line = fitted(sums);
    const Vector2d along = line.along();
    double low = 1e300;
    double high = -1e300;
    std::vector<int64_t> covered;
    for (const std::size_t i : members) {
      const SliceFace& face = faces_[i].sums;
      const double at = along.dot(faces_[i].middle);
      // Points that are spread evenly reach so far from their middle.
      const double variance = along.dot((face.squares / face.points) * along) - at * at;
      const double reach = std::sqrt(3.0 * std::max(0.0, variance));
      low = std::min(low, at - reach);
      high = std::max(high, at + reach);
      covered.push_back(std::llround(at / SliceCells::kEdge));
    }
    std::ranges::sort(covered);
    const auto doubled = std::ranges::unique(covered);
    const double share =
        SliceCells::kEdge * static_cast<double>(covered.size() - doubled.size()) / (high - low);
    if (!(high - low >= kShortest) || share < kCovered ||
        sums.points < kAgreeing * (sums.points + disagreeing(line, members))) {
      return;
    }
    const Vector2d foot = line.middle - along.dot(line.middle) * along;
    walls_.push_back({.from = foot + low * along,
                      .to = foot + high * along,
                      .spread = line.spread,
                      .points = sums.points});
    for (const std::size_t i : members) {
      faces_[i].used = true;
    }
    hide_behind(line, members, low, high);
  }

  /// One surface faces one way: what else does close to a wall cannot have been seen beside it. It
  /// is of cells that hold both faces of the wall, or of a wrong pose.
  void hide_behind(const FittedLine& line, const std::vector<std::size_t>& members, double low,
                   double high) {
    for (const std::size_t member : members) {
      near(faces_[member].key, kMerged, [&](std::size_t i) {
        const double at = line.along().dot(faces_[i].middle);
        if (line.normal.dot(faces_[i].normal) >= kSameWay && at >= low && at <= high &&
            std::abs(line.off(faces_[i].middle)) <= kMerged) {
          faces_[i].hidden = true;
        }
      });
    }
  }

  /// Whether a place lies on a wall, whatever its surface looked like.
  bool on_wall(const WallIndex& index, const Vector2d& place) const {
    return std::ranges::any_of(index.near(place), [&](std::size_t i) {
      return distance(walls_[i], place) <= std::max(bound(), SliceCells::kEdge);
    });
  }

  std::vector<Vector2d> rest() const {
    std::vector<Vector2d> places;
    const WallIndex index(walls_, kWidestGap);
    const SliceCells::Key* last = nullptr;
    for (const Face& face : faces_) {
      const bool same = last != nullptr && (*last)[0] == face.key[0] && (*last)[1] == face.key[1];
      if (face.used || same || on_wall(index, face.middle)) {
        continue;
      }
      last = &face.key;
      places.emplace_back(origin_ +
                          SliceCells::kEdge * (Vector2d(static_cast<double>(face.key[1]),
                                                        static_cast<double>(face.key[0])) +
                                               Vector2d::Constant(0.5)));
    }
    return places;
  }

  Vector2d origin_;
  std::vector<Face> faces_;  // in the order of keys
  std::vector<WallSegment> walls_;
  double noise_ = 0.0;
};

}  // namespace

void SliceFace::add(const Vector2d& place, const Vector2d& normal) {
  points += 1.0;
  sum += place;
  squares += place * place.transpose();
  if (normal.norm() > 0.0) {
    normals += normal.normalized();
  }
}

SliceFace& SliceFace::operator+=(const SliceFace& other) {
  points += other.points;
  sum += other.sum;
  squares += other.squares;
  normals += other.normals;
  return *this;
}

void SliceCells::add(const Vector2d& place, const Vector2d& normal) {
  if (faces_.empty()) {
    origin_ = kEdge * (place / kEdge).array().floor().matrix();
  }
  const Vector2d p = place - origin_;
  int64_t way = kWays;
  if (normal.norm() > 0.0) {
    const double turn = std::atan2(normal.y(), normal.x()) / (2.0 * std::numbers::pi);
    way = ((std::llround(turn * kWays) % kWays) + kWays) % kWays;
  }
  faces_[{static_cast<int64_t>(std::floor(p.y() / kEdge)),
          static_cast<int64_t>(std::floor(p.x() / kEdge)), way}]
      .add(p, normal);
}

WallLines find_walls(const SliceCells& cells) {
  return WallFinder(cells).find();
}

}  // namespace adit
