// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A building with a repeated wing: two storeys of the office side by side that are alike to the
// last desk, and a long passage from the end of the one to the beginning of the other that is like
// nothing else. Who looks at the second wing alone takes it for the first.
#include <algorithm>
#include <vector>

#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/simulator/scene_office.hpp"
#include "adit/tools/simulator/scene_passages.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kThin = 0.2;  // m, of floors and ceilings

/// A storey of the office with walls at its ends, whose corridor stays open.
Mesh make_wing(Random& random) {
  Mesh wing;
  add_office_storey(wing, 0.0, random);
  for (const double x : {-kThin, kOfficeLength}) {
    for (const double side : {-1.0, 1.0}) {
      const double inner = side * kOfficeCorridor;
      const double outer = side * kOfficeOuter;
      add_block(wing, {x, std::min(inner, outer), 0.0},
                {x + kThin, std::max(inner, outer), kOfficeCeiling}, Material::plaster);
    }
  }
  return wing;
}

}  // namespace

Scene make_wings(uint64_t seed) {
  Random random(seed);
  Scene scene;
  // Between the corridors of both wings: the passage back lies between them.
  const double apart = 2.0 * (kOfficeOuter + kHalfPassage) + random.uniform(0.2, 4.0);
  const double south = -random.uniform(60.0, 130.0);
  const double east = kOfficeLength + 12.0;
  const double west = -12.0;
  const Mesh wing = make_wing(random);
  add_copy(scene.mesh, wing, Vector3d::Zero());
  add_copy(scene.mesh, wing, {0.0, apart, 0.0});
  const std::vector<Vector2d> between{{kOfficeLength, 0.0}, {east, 0.0},   {east, south},
                                      {west, south},        {west, apart}, {0.0, apart}};
  const double middle = 0.5 * apart;
  const std::vector<Vector2d> back{{kOfficeLength, apart},
                                   {kOfficeLength + 6.0, apart},
                                   {kOfficeLength + 6.0, middle},
                                   {-6.0, middle},
                                   {-6.0, 0.0},
                                   {0.0, 0.0}};
  add_way(scene.mesh, between, random);
  add_way(scene.mesh, back, random);
  for (const std::vector<Vector2d>* way : {&between, &back}) {
    for (const Vector2d& corner : *way) {
      scene.route.emplace_back(corner.x(), corner.y(), 0.0);
    }
  }
  scene.corner_radius = 0.9;
  scene.speed = 1.6;
  return scene;
}

}  // namespace adit
