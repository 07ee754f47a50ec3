// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/self_test/self_test_scene.hpp"

#include <cmath>
#include <limits>
#include <map>

namespace adit::engine {
namespace {

using Cell = std::array<int, 3>;

constexpr double kCell = 0.25;          // m, r_input
constexpr double kSurfaceCell = 0.625;  // m, 2.5 * r_input: all points are near enough for level 0
constexpr int kPointsForANormal = 5;

// Cells [begin, end) of a plane; along the normal one layer, begin[axis].
struct Patch {
  int axis;
  double towards_sensor;  // sign of the normal
  Cell begin;
  Cell end;
};

// No surface cell holds points of two patches, so that all points of one lie in a plane.
constexpr std::array kPatches = {
    Patch{2, 1.0, {0, -2, -6}, {16, 12, -5}},   // floor, z = -1.45 m
    Patch{0, -1.0, {16, -2, -3}, {17, 12, 7}},  // wall, x = 4.05 m
    Patch{1, -1.0, {0, 12, -3}, {14, 13, 7}},   // wall, y = 3.05 m
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

  std::map<Cell, int> neighbours;
  const auto surface_cell = [](const std::array<double, 3>& p) {
    return Cell{static_cast<int>(std::floor(p[0] / kSurfaceCell)),
                static_cast<int>(std::floor(p[1] / kSurfaceCell)),
                static_cast<int>(std::floor(p[2] / kSurfaceCell))};
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
    neighbours[surface_cell(point.centroid)] += 1;
    scene.cloud.push_back(point);
  });
  for (const size_t place : {size_t{2}, size_t{3}}) {
    for_each_cell([&](const Patch& patch, const Cell& cell) {
      add_raw(place_in(patch, cell, kPlaces[place]), 200.0);
    });
  }
  for (KnownPoint& point : scene.cloud) {
    point.plane = neighbours[surface_cell(point.centroid)] >= kPointsForANormal;
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
