// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/ground_volume.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Cholesky>

#include "adit/slam/core/median.hpp"

namespace adit {
namespace {

using Index = GroundHeights::Index;

// Of a normal distribution: half of it lies within so many standard deviations of its middle.
constexpr double kQuartile = 0.6745;
constexpr double kChanged = 3.0;  // standard deviations: 3 of 1000 unchanged cells are beyond
constexpr int64_t kRim =
    2;  // cells around those: what is steeper than 7 degrees has its foot in 0.5 m
// Patches that a variance is known from to a quarter of itself, and cells that make some.
constexpr std::size_t kLeastPatches = 30;
constexpr std::size_t kLeastCells = 100;
constexpr int64_t kLargestPatch = 256;  // cells along a side

constexpr std::array<Index, 4> kDirections = {Index{0, 1}, Index{1, 0}, Index{1, 1}, Index{1, -1}};

struct Sum {
  double sum = 0.0;
  double count = 0.0;

  void add(double value) {
    sum += value;
    count += 1.0;
  }
};

/// Of each cell that lies in gaps, the heights that lines across have there.
void cross_gap(const GroundHeights& ground, const Index& from, double height, const Index& step,
               std::map<Index, Sum>& gaps) {
  const double length =
      ground.size() * std::hypot(static_cast<double>(step[0]), static_cast<double>(step[1]));
  for (int64_t n = 1; n <= kGroundGap + 1; ++n) {
    const auto there = ground.at({from[0] + n * step[0], from[1] + n * step[1]});
    if (!there) {
      continue;
    }
    if (std::abs(*there - height) <= static_cast<double>(n) * length + kGroundStep) {
      for (int64_t k = 1; k < n; ++k) {
        const double share = static_cast<double>(k) / static_cast<double>(n);
        gaps[{from[0] + k * step[0], from[1] + k * step[1]}].add(height +
                                                                 share * (*there - height));
      }
    }
    return;
  }
}

/// The middle of the shortest interval that holds half of the sorted values, and its half length.
std::pair<double, double> shortest_half(const std::vector<double>& sorted) {
  const std::size_t half = sorted.size() / 2;
  std::size_t best = 0;
  for (std::size_t i = 0; i + half < sorted.size(); ++i) {
    if (sorted[i + half] - sorted[i] < sorted[best + half] - sorted[best]) {
      best = i;
    }
  }
  return {0.5 * (sorted[best + half] + sorted[best]), 0.5 * (sorted[best + half] - sorted[best])};
}

/// Rounded down, of negative numbers, too.
int64_t block_of(int64_t cell, int64_t size) {
  return cell / size - static_cast<int64_t>(cell % size < 0);
}

std::vector<StableGround::Patches> patches_of(const std::map<Index, double>& residuals,
                                              double square) {
  std::vector<StableGround::Patches> patches;
  for (int64_t side = 1; side <= kLargestPatch; side *= 2) {
    std::map<Index, Sum> blocks;
    for (const auto& [cell, residual] : residuals) {
      blocks[{block_of(cell[0], side), block_of(cell[1], side)}].add(residual);
    }
    Sum squares;
    Sum cells;
    for (const auto& [block, sum] : blocks) {
      if (2.0 * sum.count >= static_cast<double>(side * side)) {
        squares.add(std::pow(sum.sum / sum.count, 2));
        cells.add(sum.count);
      }
    }
    if (squares.count < static_cast<double>(kLeastPatches)) {
      break;
    }
    patches.push_back(
        {.area = square * cells.sum / cells.count, .variance = squares.sum / squares.count});
  }
  return patches;
}

void visit_around(const Index& cell, int64_t reach, const auto& visit) {
  for (int64_t y = -reach; y <= reach; ++y) {
    for (int64_t x = -reach; x <= reach; ++x) {
      visit(Index{cell[0] + y, cell[1] + x});
    }
  }
}

/// Whether each cell that counts is of what was filled in; of differences without their offset.
std::map<Index, bool> changed_cells(const std::map<Index, double>& differences, double spread,
                                    double least_cells) {
  std::map<Index, bool> changed;
  std::set<Index> visited;
  for (const auto& [seed, of_seed] : differences) {
    if (std::abs(of_seed) < kChanged * spread || !visited.insert(seed).second) {
      continue;
    }
    std::vector<Index> place = {seed};
    for (std::size_t i = 0; i < place.size(); ++i) {
      visit_around(place[i], 1, [&, fills = of_seed > 0.0](const Index& beside) {
        const auto found = differences.find(beside);
        if (found != differences.end() && (found->second > 0.0) == fills &&
            std::abs(found->second) >= kChanged * spread && visited.insert(beside).second) {
          place.push_back(beside);
        }
      });
    }
    if (static_cast<double>(place.size()) >= least_cells) {
      for (const Index& cell : place) {
        changed.emplace(cell, of_seed > 0.0);
      }
    }
  }
  std::map<Index, bool> rim;
  for (const auto& [cell, fills] : changed) {
    visit_around(cell, kRim, [&, fill = fills](const Index& beside) {
      if (differences.contains(beside) && !changed.contains(beside)) {
        rim.emplace(beside, fill);
      }
    });
  }
  changed.merge(rim);
  return changed;
}

}  // namespace

ClosedGround closed_gaps(const GroundHeights& ground) {
  ClosedGround closed{.heights = ground};
  std::map<Index, Sum> gaps;
  for (const auto& [cell, height] : ground.cells()) {
    for (const Index& direction : kDirections) {
      cross_gap(ground, cell, height, direction, gaps);
    }
  }
  for (const auto& [cell, sum] : gaps) {
    closed.heights.set(cell, sum.sum / sum.count);
    closed.closed.insert(cell);
  }
  return closed;
}

GroundPair ground_pair(const GroundLevels& before, const GroundLevels& after, double size) {
  GroundHeights first(size);
  GroundHeights second(size);
  for (const auto& [cell, heights] : before) {
    double low = heights.front();
    const auto other = after.find(cell);
    if (other != after.end()) {
      double high = other->second.front();
      for (const double one : heights) {
        for (const double two : other->second) {
          if (std::abs(two - one) < std::abs(high - low)) {
            low = one;
            high = two;
          }
        }
      }
      second.set(cell, high);
    }
    first.set(cell, low);
  }
  for (const auto& [cell, heights] : after) {
    if (!before.contains(cell)) {
      second.set(cell, heights.front());
    }
  }
  return {.before = closed_gaps(first), .after = closed_gaps(second)};
}

GroundHeights difference_of(const GroundHeights& after, const GroundHeights& before) {
  GroundHeights difference(after.size());
  for (const auto& [cell, height] : after.cells()) {
    if (const auto other = before.at(cell)) {
      difference.set(cell, height - *other);
    }
  }
  return difference;
}

double StableGround::error_of_mean(double over) const {
  double largest = 0.0;
  for (const Patches& one : patches) {
    largest = std::max(largest, one.variance * std::min(1.0, one.area / std::max(over, 1e-9)));
  }
  return std::sqrt(largest);
}

std::optional<StableGround> stable_ground(const GroundHeights& differences) {
  std::vector<double> sorted;
  for (const auto& [cell, difference] : differences.cells()) {
    sorted.push_back(difference);
  }
  if (sorted.size() < kLeastCells) {
    return {};
  }
  std::ranges::sort(sorted);
  const auto [middle, half] = shortest_half(sorted);
  const double spread = half / kQuartile;
  if (spread > kGroundStep) {
    return {};
  }
  std::map<Index, double> stable;
  Sum mean;
  for (const auto& [cell, difference] : differences.cells()) {
    if (std::abs(difference - middle) <= kChanged * std::max(spread, kLeastSpread)) {
      stable.emplace(cell, difference);
      mean.add(difference);
    }
  }
  StableGround ground;
  const double square = differences.size() * differences.size();
  ground.offset = mean.sum / mean.count;
  ground.area = square * mean.count;
  double squares = 0.0;
  for (auto& [cell, difference] : stable) {
    difference -= ground.offset;
    squares += difference * difference;
  }
  ground.spread = std::sqrt(squares / mean.count);
  ground.patches = patches_of(stable, square);
  return ground;
}

GroundVolume ground_volume(const GroundHeights& differences, const VolumeRule& rule,
                           const std::function<bool(const Index&)>& is_wanted) {
  std::map<Index, double> wanted;
  for (const auto& [cell, difference] : differences.cells()) {
    if (is_wanted(cell)) {
      wanted.emplace(cell, difference - rule.offset);
    }
  }
  const auto& stable = rule.stable;
  const double spread = stable ? std::max(stable->spread, kLeastSpread) : 0.0;
  const std::map<Index, bool> changed =
      changed_cells(wanted, spread, rule.least_area / rule.square);
  GroundVolume volume;
  for (const auto& [cell, difference] : wanted) {
    volume.compared += rule.square;
    const auto fills = changed.find(cell);
    if (fills == changed.end()) {
      volume.rest += rule.square * difference;
      continue;
    }
    MeasuredVolume& part = fills->second ? volume.fill : volume.cut;
    part.volume += rule.square * (fills->second ? difference : -difference);
    part.area += rule.square;
  }
  volume.net.volume = volume.fill.volume - volume.cut.volume;
  volume.net.area = volume.fill.area + volume.cut.area;
  // A common error of heights adds to fill what it takes from cut, and to net both.
  for (MeasuredVolume* part : {&volume.fill, &volume.cut, &volume.net}) {
    part->error = part->area *
                  std::hypot(stable ? stable->error_of_mean(part->area) : 0.0, rule.offset_error);
  }
  return volume;
}

std::optional<GroundPlane> plane_through(const GroundHeights& heights) {
  constexpr double kTukey = 4.685;  // scales: 95 % as efficient as least squares
  constexpr int kFits = 20;
  GroundPlane plane;
  for (const auto& [cell, height] : heights.cells()) {
    plane.middle += heights.middle(cell) / static_cast<double>(heights.cells().size());
  }
  double scale = 0.0;
  for (int fit = 0; fit < kFits; ++fit) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    std::vector<double> residuals;
    for (const auto& [cell, height] : heights.cells()) {
      const Eigen::Vector2d from = heights.middle(cell) - plane.middle;
      const Eigen::Vector3d row(1.0, from.x(), from.y());
      const double residual = height - plane.at(heights.middle(cell));
      const double share = fit == 0 ? 0.0 : residual / (kTukey * scale);
      const double weight = std::abs(share) < 1.0 ? std::pow(1.0 - share * share, 2) : 0.0;
      information += weight * row * row.transpose();
      right += weight * height * row;
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(information);
    if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-9)) {
      return {};
    }
    const Eigen::Vector3d solved = solver.solve(right);
    plane.height = solved.x();
    plane.slope = solved.tail<2>();
    for (const auto& [cell, height] : heights.cells()) {
      residuals.push_back(std::abs(height - plane.at(heights.middle(cell))));
    }
    scale = std::max(1e-4, median(residuals) / kQuartile);
  }
  return plane;
}

}  // namespace adit
