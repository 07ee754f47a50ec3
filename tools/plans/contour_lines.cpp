// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/contour_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

namespace adit {
namespace {

using Eigen::Vector2d;

/// A side between the middles of two cells: the lower one, and 0 to the next column, 1 to the next
/// row.
using Side = std::array<int64_t, 3>;

/// The lines of one height while they are put together: each side that is crossed is an end of up
/// to two pieces.
class LineOfHeight {
 public:
  LineOfHeight(const GroundHeights& ground, double height) : ground_(&ground), height_(height) {}

  void add(const Side& from, const Side& to) {
    next_[from].push_back(to);
    next_[to].push_back(from);
  }

  std::vector<ContourLine> lines() {
    std::vector<ContourLine> lines;
    // Open lines from their ends first; what is left then is closed.
    for (const bool open : {true, false}) {
      for (const auto& [side, others] : next_) {
        if (!others.empty() && (!open || others.size() == 1)) {
          ContourLine line = walk(side, !open);
          // A corner that has the height itself is no line.
          if ((line.places.front() - line.places[line.places.size() / 2]).norm() > 0.0) {
            lines.push_back(std::move(line));
          }
        }
      }
    }
    return lines;
  }

 private:
  ContourLine walk(Side at, bool closed) {
    ContourLine line{.height = height_, .closed = closed};
    line.places.push_back(place(at));
    while (!next_.at(at).empty()) {
      const Side to = next_.at(at).back();
      next_.at(at).pop_back();
      std::vector<Side>& back = next_.at(to);
      back.erase(std::ranges::find(back, at));
      at = to;
      line.places.push_back(place(at));
    }
    if (closed) {
      line.places.pop_back();
    }
    return line;
  }

  Vector2d place(const Side& side) const {
    const GroundHeights::Index low = {side[0], side[1]};
    const GroundHeights::Index high = {side[0] + side[2], side[1] + 1 - side[2]};
    const double from = *ground_->at(low);
    const double share = (height_ - from) / (*ground_->at(high) - from);
    return ground_->middle(low) + share * (ground_->middle(high) - ground_->middle(low));
  }

  const GroundHeights* ground_;
  double height_;
  std::map<Side, std::vector<Side>> next_;
};

/// Corners of a square between four cells, counter-clockwise from the lowest row and column.
using Corners = std::array<double, 4>;

/// Adds the pieces of a height within a square.
void add_square(LineOfHeight& line, const GroundHeights::Index& cell, const Corners& corners,
                double height) {
  const auto [y, x] = cell;
  const std::array<Side, 4> sides = {Side{y, x, 0}, Side{y, x + 1, 1}, Side{y + 1, x, 0},
                                     Side{y, x, 1}};  // from corner to corner
  std::vector<std::size_t> crossed;
  for (std::size_t i = 0; i < 4; ++i) {
    if ((corners[i] >= height) != (corners[(i + 1) % 4] >= height)) {
      crossed.push_back(i);
    }
  }
  if (crossed.size() == 2) {
    line.add(sides[crossed[0]], sides[crossed[1]]);
  } else if (crossed.size() == 4) {  // a saddle: its middle says which corners belong together
    const double middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    const bool first_alone = (corners[0] >= height) != (middle >= height);
    line.add(sides[0], sides[first_alone ? 3 : 1]);
    line.add(sides[2], sides[first_alone ? 1 : 3]);
  }
}

}  // namespace

std::vector<ContourLine> contour_lines(const GroundHeights& ground, double step) {
  std::map<int64_t, LineOfHeight> by_height;
  for (const auto& [cell, height] : ground.cells()) {
    const auto right = ground.at({cell[0], cell[1] + 1});
    const auto above = ground.at({cell[0] + 1, cell[1]});
    const auto across = ground.at({cell[0] + 1, cell[1] + 1});
    if (!right || !above || !across) {
      continue;
    }
    const Corners corners = {height, *right, *across, *above};
    const auto [low, high] = std::ranges::minmax(corners);
    for (auto n = static_cast<int64_t>(std::ceil(low / step));
         static_cast<double>(n) * step <= high; ++n) {
      const double level = static_cast<double>(n) * step;
      add_square(by_height.try_emplace(n, ground, level).first->second, cell, corners, level);
    }
  }
  std::vector<ContourLine> lines;
  for (auto& [n, line] : by_height) {
    std::ranges::move(line.lines(), std::back_inserter(lines));
  }
  return lines;
}

}  // namespace adit
