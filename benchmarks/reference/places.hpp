// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twins of place_describe.comp, place_match.comp and place_correlate.comp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "adit/benchmarks/reference/surfaces.hpp"
#include "adit/shaders/shared/places.h"

namespace adit::reference {

/// Bits of a place. What float32 may decide otherwise, so near to a border a point lies, is
/// possible but not certain.
struct DescribedPlace {
  using Bit = std::array<int, 3>;  ///< sector, layer, ring
  using Square = std::array<int, 2>;
  std::set<Bit> certain_bits, possible_bits;
  std::set<Square> certain_cells, possible_cells;
};

inline constexpr double kBorder = 2e-6;      ///< of an angle (rad), and of a ratio of ranges
inline constexpr double kCellBorder = 1e-4;  ///< cells
/// Of heights (m), and of a direction's z, which is packed to 0.005 degrees.
inline constexpr double kHeightBorder = 1e-6;
inline constexpr double kUpwardsBorder = 1e-5;

/// Stands rather than lies: certainly, possibly.
inline std::pair<bool, bool> stands(const SurfacePoint& point) {
  const double upwards = std::abs(point.direction.z());
  const auto above = [](double value, double limit, double border) {
    return std::pair(value > limit + border, value > limit - border);
  };
  const auto off_ground = above(point.p.z(), gpu::kOffGround, kHeightBorder);
  if (is_plane(point.kind)) {
    const auto lies = above(upwards, 0.7, kUpwardsBorder);
    return {!lies.second, !lies.first};
  }
  if (point.kind == SurfaceKind::line) {
    const auto steep = above(upwards, 0.5, kUpwardsBorder);
    return {steep.first || off_ground.first, steep.second || off_ground.second};
  }
  return off_ground;
}

/// The whole numbers that a value may be rounded down to.
inline std::set<int> floors(double value, double border) {
  return {static_cast<int>(std::floor(value - border)),
          static_cast<int>(std::floor(value + border))};
}

/// `cell` is the edge of a cell of the plan, m.
inline DescribedPlace describe_place(std::span<const SurfacePoint> points, double cell) {
  DescribedPlace place;
  for (const SurfacePoint& point : points) {
    const auto [certain, possible] = stands(point);
    if (!possible) {
      continue;
    }
    const Eigen::Vector3d& p = point.p;
    const double sector_width = 2.0 * std::numbers::pi / gpu::kPlaceSectors;
    const double angle = std::atan2(p.y(), p.x());
    const double range = p.head<2>().norm();
    std::set<DescribedPlace::Bit> bits;
    for (const int sector : floors(angle / sector_width, kBorder / sector_width)) {
      for (const int ring : floors(6.0 * (std::log2(range) - 1.0), 12.0 * kBorder)) {
        for (const int layer : floors(p.z() - gpu::kUpperLayer, kHeightBorder)) {
          if (ring >= 0 && ring < 32) {
            const int sectors = static_cast<int>(gpu::kPlaceSectors);
            bits.insert({(sector + sectors) % sectors, layer >= 0 ? 1 : 0, ring});
          }
        }
      }
    }
    std::set<DescribedPlace::Square> cells;
    const int half = static_cast<int>(gpu::kPlanSide / 2);
    for (const int x : floors(p.x() / cell, kCellBorder)) {
      for (const int y : floors(p.y() / cell, kCellBorder)) {
        if (std::max(std::max(x, -1 - x), std::max(y, -1 - y)) < half) {
          cells.insert({x + half, y + half});
        }
      }
    }
    place.possible_bits.insert(bits.begin(), bits.end());
    place.possible_cells.insert(cells.begin(), cells.end());
    if (certain && bits.size() == 1) {
      place.certain_bits.insert(bits.begin(), bits.end());
    }
    if (certain && cells.size() == 1) {
      place.certain_cells.insert(cells.begin(), cells.end());
    }
  }
  return place;
}

/// The bits of a polar view, gpu::kPolarWords words.
inline std::set<DescribedPlace::Bit> polar_bits(std::span<const uint32_t> words) {
  std::set<DescribedPlace::Bit> bits;
  for (std::size_t i = 0; i < gpu::kPolarWords; ++i) {
    for (int ring = 0; ring < 32; ++ring) {
      if ((words[i] >> static_cast<unsigned>(ring) & 1U) != 0) {
        bits.insert({static_cast<int>(i / gpu::kPlaceLayers),
                     static_cast<int>(i % gpu::kPlaceLayers), ring});
      }
    }
  }
  return bits;
}

/// The cells of a plan, gpu::kPlanWords words.
inline std::set<DescribedPlace::Square> plan_cells(std::span<const uint32_t> words) {
  std::set<DescribedPlace::Square> cells;
  for (int y = 0; y < static_cast<int>(gpu::kPlanSide); ++y) {
    for (int x = 0; x < static_cast<int>(gpu::kPlanSide); ++x) {
      const auto word =
          static_cast<std::size_t>(y) * gpu::kPlanRow + static_cast<std::size_t>(x / 32);
      if ((words[word] >> static_cast<unsigned>(x % 32) & 1U) != 0) {
        cells.insert({x, y});
      }
    }
  }
  return cells;
}

/// Whether a bit is within one sector and one ring of one of the query's in the same layer, the
/// query being turned back by so many sectors.
inline bool is_beside(const std::set<DescribedPlace::Bit>& query, const DescribedPlace::Bit& bit,
                      int turn) {
  const int sectors = static_cast<int>(gpu::kPlaceSectors);
  for (int sector = -1; sector <= 1; ++sector) {
    for (int ring = -1; ring <= 1; ++ring) {
      if (query.contains({(bit[0] + turn + sector + sectors) % sectors, bit[1], bit[2] + ring})) {
        return true;
      }
    }
  }
  return false;
}

/// Bits of `place` that are beside one of the query's, and once more those that are one.
inline int polar_hits(const std::set<DescribedPlace::Bit>& query,
                      const std::set<DescribedPlace::Bit>& place, int turn) {
  const int sectors = static_cast<int>(gpu::kPlaceSectors);
  int hits = 0;
  for (const DescribedPlace::Bit& bit : place) {
    hits += is_beside(query, bit, turn) ? 1 : 0;
    hits += query.contains({(bit[0] + turn) % sectors, bit[1], bit[2]}) ? 1 : 0;
  }
  return hits;
}

/// Hits of a correlation at one shift, and by how many float32 may count otherwise.
struct PlanHits {
  int hits = 0;
  int uncertain = 0;
};

/// Cells are centres from the origin; `x` and `y` are the shift, in cells. A cell that falls onto
/// one of the plan counts two, one that falls beside it one.
inline PlanHits plan_hits(std::span<const Eigen::Vector2d> cells,
                          const std::set<DescribedPlace::Square>& plan, double angle, int x,
                          int y) {
  const int half = static_cast<int>(gpu::kPlanSide / 2);
  const Eigen::Rotation2Dd turn(angle);
  const auto hits_at = [&](int column, int row) {
    if (std::min(column, row) < 0 || std::max(column, row) >= 2 * half) {
      return 0;
    }
    int hits = plan.contains({column, row}) ? 1 : 0;
    for (int i = 0; i < 9; ++i) {
      if (plan.contains({column + i % 3 - 1, row + i / 3 - 1})) {
        return hits + 1;
      }
    }
    return hits;
  };
  PlanHits result;
  for (const Eigen::Vector2d& cell : cells) {
    const Eigen::Vector2d at = turn * cell + Eigen::Vector2d(x + half, y + half);
    std::set<int> possible;
    for (const int column : floors(at.x(), kCellBorder)) {
      for (const int row : floors(at.y(), kCellBorder)) {
        possible.insert(hits_at(column, row));
      }
    }
    result.hits += *possible.rbegin();
    result.uncertain += *possible.rbegin() - *possible.begin();
  }
  return result;
}

}  // namespace adit::reference
