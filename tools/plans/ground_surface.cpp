// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/ground_surface.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

namespace adit {
namespace {

// Crushed rock lies at 45 degrees at most; sand and earth lie flatter.
constexpr double kSteepest = 1.0;
constexpr double kLevelSurface = 0.7;  // of a normal's z: 45 degrees
constexpr double kLevelHeight = 0.25;  // m: surfaces that are closer to each other are one
constexpr double kUnderPath = 0.5;     // m, of the ground from the floor under the sensor

constexpr double kBesidePath = 1.0;  // m

/// Goes over the ground from surface to surface.
class Flood {
 public:
  Flood(std::map<GroundHeights::Index, std::vector<double>> surfaces, double size)
      : surfaces_(std::move(surfaces)), grid_(size) {}

  /// Begins at surfaces within `reach` (m) of a step, whose height is its floor's within `most`
  /// (m).
  void begin(const FloorStep& step, double reach, double most) {
    visit_around(step, reach, [&](const GroundHeights::Index& cell) {
      take(cell, step.floor, most);
      return false;
    });
  }

  void run() {
    while (!waiting_.empty()) {
      const Reached at = waiting_.front();
      waiting_.pop_front();
      for (int64_t dy = -1; dy <= 1; ++dy) {
        for (int64_t dx = -1; dx <= 1; ++dx) {
          const double distance =
              grid_.size() * std::hypot(static_cast<double>(dy), static_cast<double>(dx));
          bool found = dx == 0 && dy == 0;
          for (int64_t n = 1; !found && n <= kGroundGap + 1; ++n) {
            found = take({at.cell[0] + n * dy, at.cell[1] + n * dx}, at.height,
                         kSteepest * distance + kGroundStep);
          }
        }
      }
    }
  }

  /// Whether the ground near the step, at the height of its floor, was reached.
  bool has_ground_at(const FloorStep& step) const {
    return visit_around(step, kBesidePath, [&](const GroundHeights::Index& cell) {
      const auto known = ground_.find(cell);
      return known != ground_.end() && std::ranges::any_of(known->second, [&](double height) {
               return std::abs(height - step.floor) <= kUnderPath;
             });
    });
  }

  GroundLevels ground() const { return ground_; }

 private:
  struct Reached {
    GroundHeights::Index cell;
    double height = 0.0;
  };

  /// Until `visit` says that it has found what it looks for; whether it did.
  template <class Visit>
  bool visit_around(const FloorStep& step, double reach, const Visit& visit) const {
    const auto cells = static_cast<int64_t>(std::ceil(reach / grid_.size()));
    const GroundHeights::Index under = grid_.index_of(step.sensor.head<2>());
    for (int64_t y = under[0] - cells; y <= under[0] + cells; ++y) {
      for (int64_t x = under[1] - cells; x <= under[1] + cells; ++x) {
        if (visit(GroundHeights::Index{y, x})) {
          return true;
        }
      }
    }
    return false;
  }

  /// Whether there is anything in that cell; takes what is near enough to a height.
  bool take(const GroundHeights::Index& cell, double from, double most) {
    const auto found = surfaces_.find(cell);
    if (found == surfaces_.end()) {
      return false;
    }
    const double nearest = *std::ranges::min_element(
        found->second, {}, [&](double height) { return std::abs(height - from); });
    if (std::abs(nearest - from) <= most) {
      std::vector<double>& known = ground_[cell];
      if (std::ranges::all_of(
              known, [&](double height) { return std::abs(nearest - height) >= kLeastStorey; })) {
        known.push_back(nearest);
        waiting_.push_back({cell, nearest});
      }
    }
    return true;
  }

  std::map<GroundHeights::Index, std::vector<double>> surfaces_;
  GroundHeights grid_;
  GroundLevels ground_{};
  std::deque<Reached> waiting_{};
};

}  // namespace

std::optional<double> GroundHeights::at(const Index& cell) const {
  const auto found = heights_.find(cell);
  return found == heights_.end() ? std::nullopt : std::optional(found->second);
}

Eigen::Vector2d GroundHeights::middle(const Index& cell) const {
  return size_ *
         Eigen::Vector2d(static_cast<double>(cell[1]) + 0.5, static_cast<double>(cell[0]) + 0.5);
}

GroundHeights::Index GroundHeights::index_of(const Eigen::Vector2d& place) const {
  return {static_cast<int64_t>(std::floor(place.y() / size_)),
          static_cast<int64_t>(std::floor(place.x() / size_))};
}

void GroundSearch::add(std::span<const PlanPoint> points) {
  const GroundHeights grid(size_);
  for (const PlanPoint& point : points) {
    if (point.normal.z() > kLevelSurface) {
      const GroundHeights::Index cell = grid.index_of(point.position.head<2>());
      const double z = point.position.z();
      Level& level =
          levels_[{cell[0], cell[1], static_cast<int64_t>(std::floor(z / kLevelHeight))}];
      level.sum += z;
      level.points += 1.0;
    }
  }
}

std::map<GroundHeights::Index, std::vector<double>> GroundSearch::surfaces() const {
  std::map<GroundHeights::Index, std::vector<double>> surfaces;
  Level open;
  GroundHeights::Index cell{};
  const auto close = [&] {
    if (open.points > 0.0) {
      surfaces[cell].push_back(open.sum / open.points);
    }
    open = {};
  };
  for (const auto& [at, level] : levels_) {
    const GroundHeights::Index here = {at[0], at[1]};
    // A surface on the border of two levels is in both.
    if (here != cell ||
        (open.points > 0.0 && level.sum / level.points - open.sum / open.points > kLevelHeight)) {
      close();
    }
    cell = here;
    open.sum += level.sum;
    open.points += level.points;
  }
  close();
  return surfaces;
}

GroundLevels GroundSearch::levels_from(std::span<const FloorStep> steps) const {
  Flood flood(surfaces(), size_);
  for (const FloorStep& step : steps) {
    // The ground right under the sensor is hidden by its carrier.
    flood.begin(step, kBesidePath, kUnderPath);
  }
  flood.run();
  // Beams reach the floor far from the sensor: a short path on it is beside none of what was seen.
  std::vector<FloorStep> without;
  std::ranges::copy_if(steps, std::back_inserter(without),
                       [&](const FloorStep& step) { return !flood.has_ground_at(step); });
  for (const FloorStep& step : without) {
    flood.begin(step, kGroundReach, kGroundStep);
  }
  flood.run();
  return flood.ground();
}

GroundHeights smoothed(const GroundHeights& ground) {
  GroundHeights smooth(ground.size());
  for (const auto& [cell, height] : ground.cells()) {
    double sum = 0.0;
    int count = 0;
    for (int64_t y = cell[0] - 1; y <= cell[0] + 1; ++y) {
      for (int64_t x = cell[1] - 1; x <= cell[1] + 1; ++x) {
        if (const auto near = ground.at({y, x})) {
          sum += *near;
          ++count;
        }
      }
    }
    smooth.set(cell, sum / count);
  }
  return smooth;
}

}  // namespace adit
