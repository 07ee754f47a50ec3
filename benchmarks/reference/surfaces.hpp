// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twin of surface_normals.comp and of the moments that downsample_emit.comp gathers for it; of
// submap_surface_cells.comp and submap_surfaces.comp where each point has a sensor of its own.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "adit/benchmarks/reference/downsample.hpp"
#include "adit/engine/kernels/preprocess.hpp"
#include "adit/shaders/shared/prelude.h"
#include "adit/slam/core/types.hpp"

namespace adit::reference {

/// Numbered as in the two top bits of a packed surface.
enum class SurfaceKind : uint32_t { isotropic = 0, plane = 1, line = 2, grazing = 3 };

/// A plane, whether it is seen edge-on or not.
inline bool is_plane(SurfaceKind kind) {
  return kind == SurfaceKind::plane || kind == SurfaceKind::grazing;
}

/// The surface at a point of a cloud.
struct Surface {
  SurfaceKind kind = SurfaceKind::isotropic;
  Eigen::Vector3d direction =
      Eigen::Vector3d::UnitZ();  ///< normal towards the sensor, or along the line
  Eigen::Vector3d eigenvalues =
      Eigen::Vector3d::Zero();  ///< ascending, in squares of the surface cell's edge
  int neighbours = 0;           ///< points of the surface cell, itself included
  double incidence = 0.0;       ///< cosine between the direction and the ray to the sensor
  /// How near eigenvalues came to where they would have decided otherwise on the way here.
  double margin = std::numeric_limits<double>::infinity();
};

/// Fewer points say nothing.
inline constexpr int kMinNeighbours = 5;
/// Second over first eigenvalue below which neighbours lie on a line.
inline constexpr double kLineRatio = 0.02;
/// |z| of a direction above which a line counts as a pole or an edge.
inline constexpr double kSteep = 0.7;
/// Cosine between a plane's normal and the ray, below which it is seen edge-on.
inline constexpr double kEdgeOn = 0.174;
/// First over second eigenvalue below which several cells together show a plane.
inline constexpr double kThin = 0.02;
/// And the cosine between its normal and the ray below which it is oblique enough.
inline constexpr double kOblique = 0.5;
/// Spread of points across a plane's ray, in squares of the gap between beams, below which one beam
/// saw them.
inline constexpr double kOneBeam = 0.01;

/// The smallest level, 0 to 14, whose cells' size relative to level 0 is at least range *
/// 2.5 beam_spacing / edge of level 0, for a point at `p` from its sensor. Decided on squares in
/// float32, in this order of operations, as the device does.
inline int surface_level(const Eigen::Vector3f& p, const engine::PreprocessSettings& settings) {
  const double edge = std::max(settings.surface_size, 2.5 * settings.r_input);
  const double root = 2.5 * settings.beam_spacing / edge;
  const auto factor = static_cast<float>(root * root);
  const float squared = p.x() * p.x() + p.y() * p.y() + p.z() * p.z();
  const float ratio = squared * factor;
  int level = 0;
  while (level < 14 && std::pow(4.0, level) < static_cast<double>(ratio)) {
    ++level;
  }
  return level;
}

/// Inverse edge of a surface cell (surface_size or 2.5 r_input at level 0, twice as large with each
/// level), 1/m.
inline float inverse_surface_cell(const engine::PreprocessSettings& settings, int level) {
  return static_cast<float>(1.0 / std::max(settings.surface_size, 2.5 * settings.r_input)) /
         static_cast<float>(1U << static_cast<unsigned>(level));
}

/// The gap between neighbouring beams at the end of a ray, in cells of that level.
inline double beam_gap(const Eigen::Vector3f& ray, const engine::PreprocessSettings& settings,
                       int level) {
  return static_cast<double>(ray.norm()) * settings.beam_spacing *
         static_cast<double>(inverse_surface_cell(settings, level));
}

/// Whether a plane is that of the scan: of one beam that sweeps about z, across which its points
/// are not spread.
struct OneBeam {
  bool found = false;
  double margin = 0.0;  ///< how near that was to being decided otherwise, as Surface::margin
};

inline OneBeam one_beam(const Eigen::Matrix3d& covariance, const Surface& plane,
                        const Eigen::Vector3d& ray, double gap) {
  const Eigen::Vector3d along = ray.normalized();
  const Eigen::Vector3d across = plane.direction - plane.direction.dot(along) * along;
  const Eigen::Vector3d up = across.normalized();
  const double spread = up.dot(covariance * up) - kOneBeam * gap * gap;
  const double steepness = std::abs(up.z()) - kSteep;
  // What turns `up` turns the plane, by as much as its eigenvalues are near each other.
  const Eigen::Vector3d& e = plane.eigenvalues;
  const double turn = (e[1] - e[0]) * across.norm();
  const double of_spread = std::abs(spread) * std::min(1.0, turn / (2.0 * e[2]));
  const double of_steepness = std::abs(steepness) * turn;
  if (spread < 0.0 && steepness > 0.0) {
    return {.found = true, .margin = std::min(of_spread, of_steepness)};
  }
  return {.found = false,
          .margin = std::max(spread < 0.0 ? 0.0 : of_spread, steepness > 0.0 ? 0.0 : of_steepness)};
}

/// Classifies the covariance of a point's neighbours; `ray` leads to it from its sensor, where
/// beams are a `gap` of cells apart. Those of several cells (`wide`) show thin, oblique planes
/// alone.
inline Surface classify(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& ray, double gap,
                        int neighbours, bool wide) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Surface surface{.eigenvalues = solver.eigenvalues(), .neighbours = neighbours};
  const bool line = surface.eigenvalues[1] < kLineRatio * surface.eigenvalues[2];
  surface.direction = solver.eigenvectors().col(line ? 2 : 0);
  if (surface.direction.dot(ray) > 0.0) {
    surface.direction = -surface.direction;
  }
  surface.incidence = -surface.direction.dot(ray) / ray.norm();
  const Eigen::Vector3d& e = surface.eigenvalues;
  surface.margin = std::abs(e[1] - kLineRatio * e[2]);
  // An angle turns into what its eigenvalue is apart from the next.
  if (wide && !line) {
    const double oblique = std::abs(surface.incidence - kOblique) * (e[1] - e[0]);
    surface.margin = std::min({surface.margin, oblique, std::abs(e[0] - kThin * e[1])});
  }
  bool is_shown = !wide || (e[0] < kThin * e[1] && surface.incidence < kOblique);
  if (!line && !wide) {
    const OneBeam beam = one_beam(covariance, surface, ray, gap);
    surface.margin = std::min(surface.margin, beam.margin);
    is_shown = !beam.found;
  }
  if (!line && is_shown) {
    surface.kind = surface.incidence > kEdgeOn ? SurfaceKind::plane : SurfaceKind::grazing;
  } else if (line && !wide && std::abs(surface.direction.z()) > kSteep) {
    surface.kind = SurfaceKind::line;
  }
  if (line && !wide) {
    const double steepness = std::abs(std::abs(surface.direction.z()) - kSteep);
    surface.margin = std::min(surface.margin, steepness * (e[2] - e[1]));
  }
  return surface;
}

/// The surface that `neighbours` show together, in cells.
inline Surface surface_among(std::span<const Eigen::Vector3d> neighbours,
                             const Eigen::Vector3d& ray, double gap, bool wide) {
  const auto n = static_cast<int>(neighbours.size());
  if (n < kMinNeighbours) {
    return {.neighbours = n};
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& neighbour : neighbours) {
    mean += neighbour / n;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& neighbour : neighbours) {
    covariance += (neighbour - mean) * (neighbour - mean).transpose() / n;
  }
  return classify(covariance, ray, gap, n, wide);
}

/// A point of a cloud, and where it lies from the sensor that saw it, m.
struct SeenPoint {
  Eigen::Vector3f p = Eigen::Vector3f::Zero();
  Eigen::Vector3f ray = Eigen::Vector3f::Zero();
};

/// Points by the level and corner of surface cells that they lie in, in cells.
using SurfaceCells = std::map<std::pair<int, Cell>, std::vector<Eigen::Vector3d>>;

/// The point's cell of that level and those on the sides to which it lies nearer, together.
inline Surface surface_around(const SurfaceCells& cells, const SeenPoint& point, int level,
                              const engine::PreprocessSettings& settings) {
  const float inverse_edge = inverse_surface_cell(settings, level);
  const Cell own = cell_of(point.p, inverse_edge);
  const Eigen::Vector3f scaled = point.p * inverse_edge;
  Cell side{};
  double from_the_middle = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double offset = static_cast<double>(scaled[axis] - std::floor(scaled[axis]));
    side[static_cast<size_t>(axis)] = offset >= 0.5 ? 1 : -1;
    from_the_middle = std::min(from_the_middle, std::abs(offset - 0.5));
  }
  std::vector<Eigen::Vector3d> neighbours;
  for (int i = 0; i < 8; ++i) {
    const Cell at = {own[0] + side[0] * (i & 1), own[1] + side[1] * (i >> 1 & 1),
                     own[2] + side[2] * (i >> 2)};
    if (const auto found = cells.find({level, at}); found != cells.end()) {
      neighbours.insert(neighbours.end(), found->second.begin(), found->second.end());
    }
  }
  Surface surface = surface_among(neighbours, point.ray.cast<double>(), 0.0, true);
  constexpr double kUndecided = 1e-4;
  surface.margin = from_the_middle < kUndecided ? 0.0 : surface.margin;
  return surface;
}

/// Where a surface is looked for.
enum class SurfaceSearch {
  own_cell,  ///< of keyframes' submaps: many sweeps fill a cell
  wide,      ///< of a sweep, where that shows none: in eight around the point, then in wider ones
};

/// The surface at each point, from points in cells of its level; those of a sweep also lie in cells
/// that are twice as wide.
inline std::vector<Surface> surfaces(std::span<const SeenPoint> cloud,
                                     const engine::PreprocessSettings& settings,
                                     SurfaceSearch search) {
  const bool wide = search == SurfaceSearch::wide;
  SurfaceCells cells;
  for (const SeenPoint& point : cloud) {
    const int own = surface_level(point.ray, settings);
    for (int level = own; level <= own + (wide ? 1 : 0); ++level) {
      const float inverse_edge = inverse_surface_cell(settings, level);
      cells[{level, cell_of(point.p, inverse_edge)}].push_back(point.p.cast<double>() *
                                                               static_cast<double>(inverse_edge));
    }
  }
  std::vector<Surface> result;
  for (const SeenPoint& point : cloud) {
    const int level = surface_level(point.ray, settings);
    const Cell own = cell_of(point.p, inverse_surface_cell(settings, level));
    Surface surface = surface_among(cells.at({level, own}), point.ray.cast<double>(),
                                    beam_gap(point.ray, settings, level), false);
    for (int more = 0; more < 2 && wide && surface.kind == SurfaceKind::isotropic; ++more) {
      const double margin = surface.margin;
      surface = surface_around(cells, point, level + more, settings);
      surface.margin = std::min(surface.margin, margin);
    }
    result.push_back(surface);
  }
  return result;
}

/// The same for a sweep: its one sensor is the origin.
inline std::vector<SeenPoint> seen_from_origin(std::span<const Point> cloud) {
  std::vector<SeenPoint> points;
  points.reserve(cloud.size());
  for (const Point& point : cloud) {
    const Eigen::Vector3f p(point.x, point.y, point.z);
    points.push_back({.p = p, .ray = p});
  }
  return points;
}

/// A point of a surface cloud as kernels read it.
struct SurfacePoint {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  SurfaceKind kind = SurfaceKind::isotropic;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();

  /// P of C = I - (1 - epsilon) P: how well the surface fixes a match along each direction.
  Eigen::Matrix3d constraint() const {
    switch (kind) {
      case SurfaceKind::plane:
      case SurfaceKind::grazing:
        return direction * direction.transpose();
      case SurfaceKind::line:
        return Eigen::Matrix3d::Identity() - direction * direction.transpose();
      case SurfaceKind::isotropic:
        return Eigen::Matrix3d::Zero();
    }
    return Eigen::Matrix3d::Zero();
  }
};

/// Reads the packed form: class in 2 bits, octahedral direction in 2 x 15 bits.
inline SurfacePoint decode(const gpu::uvec4& packed) {
  const auto position = [](uint32_t bits) {
    float value = 0.0F;
    static_assert(sizeof(value) == sizeof(bits));
    std::memcpy(&value, &bits, sizeof(value));
    return static_cast<double>(value);
  };
  const auto octahedral = [](uint32_t bits) {
    return (static_cast<double>(bits & 0x7fffU) - 16383.0) / 16383.0;
  };
  const double u = octahedral(packed.w >> 15U);
  const double v = octahedral(packed.w);
  // The octahedron |x| + |y| + |z| = 1 seen from above; its lower half is folded outwards over the
  // diagonals.
  Eigen::Vector3d direction(u, v, 1.0 - std::abs(u) - std::abs(v));
  if (direction.z() < 0.0) {
    direction.x() = std::copysign(1.0 - std::abs(v), u);
    direction.y() = std::copysign(1.0 - std::abs(u), v);
  }
  return {.p = {position(packed.x), position(packed.y), position(packed.z)},
          .kind = static_cast<SurfaceKind>(packed.w >> 30U),
          .direction = direction.normalized()};
}

inline std::vector<SurfacePoint> decode(std::span<const gpu::uvec4> cloud) {
  std::vector<SurfacePoint> points;
  points.reserve(cloud.size());
  for (const gpu::uvec4& packed : cloud) {
    points.push_back(decode(packed));
  }
  return points;
}

}  // namespace adit::reference
