// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/self_test/self_test_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit::engine {
namespace {

using Cell = std::array<int, 3>;

constexpr double kCell = 0.25;          // m, r_input
constexpr double kSurfaceCell = 0.625;  // m, 2.5 * r_input: all points are near enough for level 0
constexpr size_t kPointsForANormal = 5;
constexpr double kLineRatio = 0.02;
constexpr double kOblique = 0.5;  // cosine of 60 degrees

// Cells [begin, end) of a plane; along the normal one layer, begin[axis].
struct Patch {
  int axis;
  double towards_sensor;  // sign of the normal
  Cell begin;
  Cell end;
};

// So far apart that surface cells that are taken together hold points of one patch: a plane.
constexpr std::array kPatches = {
    Patch{2, 1.0, {0, -2, -6}, {16, 12, -5}},       // floor, z = -1.45 m
    Patch{0, -1.0, {25, -2, -3}, {26, 12, 7}},      // wall, x = 6.3 m
    Patch{1, -1.0, {0, 21, -3}, {14, 22, 7}},       // wall, y = 5.3 m
    Patch{2, 1.0, {-12, -12, -6}, {-10, -10, -5}},  // so few points that they show no surface
};

// Places of a cell's points as fractions of its edge: along the normal and along the two other
// axes. Means: 0.2, 0.4 and 0.35, away from the borders of cells and of surface cells.
constexpr std::array<std::array<double, 3>, 4> kPlaces = {
    {{0.15, 0.2, 0.1}, {0.25, 0.6, 0.1}, {0.25, 0.2, 0.6}, {0.15, 0.6, 0.6}}};
constexpr std::array<double, 3> kMeanPlace = {0.2, 0.4, 0.35};

std::array<double, 3> place_in(const Patch& patch, const Cell& cell,
                               const std::array<double, 3>& fractions) {
  std::array<double, 3> p{};
  for (int k = 0; k < 3; ++k) {
    const int axis = (patch.axis + k) % 3;
    p[static_cast<size_t>(axis)] =
        (cell[static_cast<size_t>(axis)] + fractions[static_cast<size_t>(k)]) * kCell;
  }
  return p;
}

template <class Visit>
void for_each_cell(Visit&& visit) {
  for (const Patch& patch : kPatches) {
    for (int x = patch.begin[0]; x < patch.end[0]; ++x) {
      for (int y = patch.begin[1]; y < patch.end[1]; ++y) {
        for (int z = patch.begin[2]; z < patch.end[2]; ++z) {
          visit(patch, Cell{x, y, z});
        }
      }
    }
  }
}

void add_invalid_points(std::vector<gpu::vec4>& raw) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  raw.insert(raw.end(), {{kNan, 1.0F, 1.0F, 9.0F},
                         {1.0F, kNan, kNan, 9.0F},
                         {1.0F, 1.0F, -kInfinity, 9.0F},
                         {0.0F, 0.0F, 0.0F, 9.0F},
                         {0.1F, -0.1F, 0.2F, 9.0F},
                         {-20.0F, 1.0F, 3.0F, 9.0F}});
}

// The points of one patch show a plane unless they are few, or nearly on a line.
bool shows_a_plane(const std::vector<std::array<double, 2>>& points) {
  const auto n = static_cast<double>(points.size());
  std::array<double, 2> mean{};
  std::array<double, 3> products{};
  for (const auto& [u, v] : points) {
    mean = {mean[0] + u / n, mean[1] + v / n};
    products = {products[0] + u * u / n, products[1] + u * v / n, products[2] + v * v / n};
  }
  const double uu = products[0] - mean[0] * mean[0];
  const double uv = products[1] - mean[0] * mean[1];
  const double vv = products[2] - mean[1] * mean[1];
  const double half = std::hypot(0.5 * (uu - vv), uv);
  const double middle = 0.5 * (uu + vv);
  return points.size() >= kPointsForANormal && middle - half >= kLineRatio * (middle + half);
}

// Several cells together show what is seen at more than 60 degrees from its normal.
bool is_oblique(const KnownPoint& point) {
  double along = 0.0;
  double squared = 0.0;
  for (size_t k = 0; k < 3; ++k) {
    along += point.normal[k] * point.centroid[k];
    squared += point.centroid[k] * point.centroid[k];
  }
  return std::abs(along) < kOblique * std::sqrt(squared);
}

// What surface_normals.comp takes together, along the patch: the points of a point's own cell, or
// also those of the cells on the sides to which it lies nearer.
std::vector<std::array<double, 2>> points_around(const KnownScene& scene, const KnownPoint& point,
                                                 double edge, bool wide) {
  Cell least{};
  Cell most{};
  for (size_t k = 0; k < 3; ++k) {
    const double scaled = point.centroid[k] / edge;
    const int own = static_cast<int>(std::floor(scaled));
    const bool above = scaled - own >= 0.5;
    least[k] = own - (wide && !above ? 1 : 0);
    most[k] = own + (wide && above ? 1 : 0);
  }
  const auto axis = static_cast<size_t>(
      std::find_if(point.normal.begin(), point.normal.end(), [](double n) { return n != 0.0; }) -
      point.normal.begin());
  std::vector<std::array<double, 2>> points;
  for (const KnownPoint& other : scene.cloud) {
    bool within = true;
    for (size_t k = 0; k < 3; ++k) {
      const int cell = static_cast<int>(std::floor(other.centroid[k] / edge));
      within = within && cell >= least[k] && cell <= most[k];
    }
    if (within) {
      points.push_back({other.centroid[(axis + 1) % 3], other.centroid[(axis + 2) % 3]});
    }
  }
  return points;
}

}  // namespace

KnownScene make_known_scene() {
  KnownScene scene;
  scene.settings = {
      .c_min = 0.5, .c_max = 10.0, .r_input = kCell, .beam_spacing = 0.007, .surface_size = 0.0};
  const auto add_raw = [&scene](const std::array<double, 3>& p, double intensity) {
    scene.raw.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]),
                         static_cast<float>(p[2]), static_cast<float>(intensity)});
    scene.valid_points += 1;
  };

  add_invalid_points(scene.raw);
  for_each_cell([&](const Patch& patch, const Cell& cell) {
    KnownPoint point;
    point.centroid = place_in(patch, cell, kMeanPlace);
    point.intensity = static_cast<double>(scene.cloud.size() % 100);
    point.normal[static_cast<size_t>(patch.axis)] = patch.towards_sensor;
    add_raw(place_in(patch, cell, kPlaces[0]), point.intensity);
    add_raw(place_in(patch, cell, kPlaces[1]), 200.0);
    if (scene.cloud.size() % 40 == 0) {
      add_invalid_points(scene.raw);
    }
    scene.cloud.push_back(point);
  });
  for (const size_t place : {size_t{2}, size_t{3}}) {
    for_each_cell([&](const Patch& patch, const Cell& cell) {
      add_raw(place_in(patch, cell, kPlaces[place]), 200.0);
    });
  }
  for (KnownPoint& point : scene.cloud) {
    point.plane = shows_a_plane(points_around(scene, point, kSurfaceCell, false)) ||
                  (is_oblique(point) &&
                   (shows_a_plane(points_around(scene, point, kSurfaceCell, true)) ||
                    shows_a_plane(points_around(scene, point, 2.0 * kSurfaceCell, true))));
  }
  return scene;
}

gpu::mat3x4 known_pose() {
  // Rodrigues' formula about the unit axis (2, -1, 2) / 3.
  constexpr double kAngle = 0.02;
  constexpr std::array<double, 3> kAxis = {2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0};
  constexpr std::array<double, 3> kShift = {0.06, -0.04, 0.05};
  const double s = std::sin(kAngle);
  const double c = std::cos(kAngle);
  const auto entry = [&](size_t i, size_t j) {
    const double cross = i == j ? 0.0 : ((j + 3 - i) % 3 == 1 ? -1.0 : 1.0) * kAxis[3 - i - j];
    return static_cast<float>((i == j ? c : 0.0) + s * cross + (1.0 - c) * kAxis[i] * kAxis[j]);
  };
  gpu::mat3x4 pose{};
  for (size_t i = 0; i < 3; ++i) {
    pose.rows[i] = {entry(i, 0), entry(i, 1), entry(i, 2), static_cast<float>(kShift[i])};
  }
  return pose;
}

}  // namespace adit::engine
