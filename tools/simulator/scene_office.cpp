// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// An office: two floors, each a corridor of 44 m with eight rooms on either side that look alike,
// some behind glass, and a staircase at the end.
#include "adit/tools/simulator/scene_office.hpp"

#include <utility>

#include "adit/tools/simulator/scene.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr int kRooms = 8;
constexpr double kRoom = kOfficeLength / kRooms;  // m along the corridor
constexpr double kStorey = 3.4;
constexpr double kWall = 0.12;
constexpr double kStairs = 46.0;  // m, where the steps begin
constexpr double kEnd = 53.0;     // m, the end of the stairwell

/// A wall along x with one opening, which is closed above `height`.
struct Opening {
  double from;
  double to;
  double low;
  double high;
};
void add_wall(Mesh& mesh, double y, double from, double to, double floor, const Opening& opening,
              Material material) {
  const auto part = [&](double x0, double x1, double z0, double z1, Material of) {
    if (x1 > x0 && z1 > z0) {
      add_block(mesh, {x0, y - 0.5 * kWall, floor + z0}, {x1, y + 0.5 * kWall, floor + z1}, of);
    }
  };
  part(from, opening.from, 0.0, kOfficeCeiling, material);
  part(opening.to, to, 0.0, kOfficeCeiling, material);
  part(opening.from, opening.to, 0.0, opening.low, material);
  part(opening.from, opening.to, opening.high, kOfficeCeiling, material);
}

void furnish(Mesh& mesh, const Vector3d& corner, double towards_window, Random& random) {
  const auto box = [&](double x, double y, double z, const Vector3d& size, Material material) {
    const Vector3d at = corner + Vector3d(x, towards_window * y, z);
    add_block(mesh, at - 0.5 * size, at + 0.5 * size, material);
  };
  const int desks = 1 + static_cast<int>(random.uniform(0.0, 2.0));
  for (int i = 0; i < desks; ++i) {
    const double x = 1.3 + 2.6 * i + random.uniform(-0.2, 0.2);
    const double y = random.uniform(3.0, 5.0);
    add_movable(mesh, "desk", [&] {
      box(x, y, 0.73, {1.6, 0.8, 0.04}, Material::wood);
      box(x - 0.75, y, 0.36, {0.05, 0.7, 0.7}, Material::metal);
      box(x + 0.75, y, 0.36, {0.05, 0.7, 0.7}, Material::metal);
      box(x + random.uniform(-0.3, 0.3), y + 0.2, 1.0, {0.55, 0.06, 0.35}, Material::dark);
    });
    add_movable(mesh, "chair", [&] {
      box(x + random.uniform(-0.3, 0.3), y - 0.8, 0.45, {0.5, 0.5, 0.1}, Material::paint);
      box(x, y - 1.0, 0.75, {0.45, 0.08, 0.6}, Material::paint);
    });
  }
  add_movable(mesh, "cabinet", [&] {
    box(random.uniform(0.8, 4.6), 6.1, 0.9, {random.uniform(0.8, 1.6), 0.4, 1.8}, Material::wood);
  });
  if (random.uniform(0.0, 1.0) < 0.5) {
    add_movable(mesh, "cabinet", [&] {
      box(5.0, random.uniform(1.0, 5.0), 0.6, {0.4, 0.9, 1.2}, Material::metal);
    });
  }
}

void add_stairwell(Mesh& mesh) {
  const double top = kStorey + kOfficeCeiling;
  add_block(mesh, {kOfficeLength, -3.0, -0.2}, {kEnd, 3.0, 0.0}, Material::concrete);
  add_block(mesh, {kOfficeLength, -3.0, top}, {kEnd, 3.0, top + 0.1}, Material::plaster);
  add_block(mesh, {kEnd, -3.0, 0.0}, {kEnd + 0.2, 3.0, top}, Material::concrete);
  for (const double side : {-1.0, 1.0}) {
    add_block(mesh, {kOfficeLength, side * 3.1 - 0.1, 0.0}, {kEnd, side * 3.1 + 0.1, top},
              Material::plaster);
    for (const double z : {0.0, kStorey}) {
      add_block(
          mesh, {kOfficeLength - 0.06, std::min(side * kOfficeCorridor, side * 3.0), z},
          {kOfficeLength + 0.06, std::max(side * kOfficeCorridor, side * 3.0), z + kOfficeCeiling},
          Material::plaster);
    }
  }
  add_block(mesh, {kOfficeLength, -3.0, kStorey - 0.2}, {kStairs, 3.0, kStorey},
            Material::concrete);
  add_block(mesh, {kStairs + 4.0, -3.0, 1.5}, {kEnd, 3.0, 1.7}, Material::concrete);
  constexpr int kSteps = 10;
  for (int i = 0; i < kSteps; ++i) {
    const double x = kStairs + 0.4 * i;
    const double z = 0.17 * (i + 1);
    add_block(mesh, {x, -2.95, z - 0.25}, {x + 0.4, -0.1, z}, Material::concrete);
    const double back = kStairs + 4.0 - 0.4 * i;
    add_block(mesh, {back - 0.4, 0.1, 1.45 + z}, {back, 2.95, 1.7 + z}, Material::concrete);
  }
  add_rod(mesh,
          {.from = {kStairs, 0.0, 1.0},
           .to = {kStairs + 4.0, 0.0, 2.7},
           .radius_from = 0.03,
           .radius_to = 0.03},
          Material::metal);
  add_rod(mesh,
          {.from = {kStairs + 4.0, 0.05, 2.7},
           .to = {kStairs, 0.05, 4.4},
           .radius_from = 0.03,
           .radius_to = 0.03},
          Material::metal);
}

}  // namespace

void add_office_storey(Mesh& mesh, double floor, Random& random) {
  const double z = floor;
  add_block(mesh, {-0.2, -kOfficeOuter, z - 0.2}, {kOfficeLength, kOfficeOuter, z},
            Material::concrete);
  add_block(mesh, {-0.2, -kOfficeOuter, z + kOfficeCeiling},
            {kOfficeLength, kOfficeOuter, z + kOfficeCeiling + 0.05}, Material::plaster);
  for (int room = 0; room < kRooms; ++room) {
    const double from = room * kRoom;
    const double to = from + kRoom;
    for (const double side : {-1.0, 1.0}) {
      const double door = from + (room % 2 == 0 ? 0.5 : kRoom - 1.5);
      const bool glass = (room + (side > 0.0 ? 1 : 0)) % 3 == 0;
      add_wall(mesh, side * kOfficeCorridor, from, to, z, {door, door + 0.95, 0.0, 2.1},
               glass ? Material::glass : Material::plaster);
      add_wall(mesh, side * kOfficeOuter, from, to, z, {from + 0.6, to - 0.6, 0.9, 2.4},
               Material::concrete);
      add_block(mesh, {from + 0.6, side * kOfficeOuter - 0.01, z + 0.9},
                {to - 0.6, side * kOfficeOuter + 0.01, z + 2.4}, Material::glass);
      add_block(mesh, {to - 0.5 * kWall, std::min(side * kOfficeCorridor, side * kOfficeOuter), z},
                {to + 0.5 * kWall, std::max(side * kOfficeCorridor, side * kOfficeOuter),
                 z + kOfficeCeiling},
                Material::plaster);
      furnish(mesh, {from, side * kOfficeCorridor, z}, side, random);
    }
    // Lamps and door frames give the corridor its only texture.
    add_block(mesh, {from + 2.0, -0.15, z + kOfficeCeiling - 0.08},
              {from + 3.4, 0.15, z + kOfficeCeiling}, Material::metal);
  }
}

Scene make_office(uint64_t seed) {
  Random random(seed);
  Scene scene;
  for (int storey = 0; storey < 2; ++storey) {
    const double floor = storey * kStorey;
    add_block(scene.mesh, {-0.2, -kOfficeOuter, floor}, {0.0, kOfficeOuter, floor + kOfficeCeiling},
              Material::plaster);
    add_office_storey(scene.mesh, floor, random);
  }
  add_stairwell(scene.mesh);
  const double half = 0.5 * kStorey;
  scene.route = {
      {2.0, -0.4, 0},        {44.5, -0.4, 0},      {45.6, -1.5, 0},      {50.0, -1.5, half},
      {51.6, -1.5, half},    {51.6, 1.4, half},    {50.0, 1.4, half},    {45.8, 1.4, kStorey},
      {44.6, 0.4, kStorey},  {2.0, 0.4, kStorey},  {1.2, 0.0, kStorey},  {2.0, -0.4, kStorey},
      {44.6, -0.4, kStorey}, {45.2, 1.0, kStorey}, {45.8, 1.7, kStorey}, {50.0, 1.7, half},
      {51.8, 1.7, half},     {51.8, -1.6, half},   {50.0, -1.6, half},   {45.8, -1.6, 0},
      {44.5, 0.4, 0},        {2.0, 0.4, 0},        {1.2, 0.0, 0}};
  scene.corner_radius = 0.7;
  scene.speed = 1.2;
  return scene;
}

}  // namespace adit
