// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A building with a repeated wing, as far aside as an odometry that drifts by a few per cent of its
// path could believe: only how far the odometry really drifts distinguishes the wings.
#include <algorithm>
#include <vector>

#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/simulator/scene_office.hpp"
#include "adit/tools/simulator/scene_passages.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kThin = 0.2;     // m, of floors, ceilings and walls
constexpr int kBlocks = 11;       // along each side of a wing
constexpr double kAisle = 1.3;    // m, from the middle of a wing to its blocks
constexpr double kShallow = 0.4;  // m, of the shallowest block

// The second wing lies aside by up to this share of the path from one place to its alias.
constexpr double kMostAside = 0.048;
constexpr double kLeastAside = 10.0;  // m

/// A block is an alcove of its own depth, or a wall, with what stands there.
void add_alcove(Mesh& mesh, double from, double to, double side, double deepest, Random& random) {
  const auto block = [&](double x0, double x1, double y0, double y1, double low, double high,
                         Material material) {
    add_block(mesh, {x0, std::min(side * y0, side * y1), low},
              {x1, std::max(side * y0, side * y1), high}, material);
  };
  const double outer = kAisle + deepest + kThin;
  const double depth = random.uniform(0.0, 1.0) < 0.2 ? 0.0 : random.uniform(kShallow, deepest);
  block(from, to, kAisle + depth, outer, 0.0, kOfficeCeiling,
        random.uniform(0.0, 1.0) < 0.5 ? Material::plaster : Material::concrete);
  block(to - 0.5 * kThin, to + 0.5 * kThin, kAisle, outer, 0.0, kOfficeCeiling, Material::plaster);
  if (depth > 1.0) {
    const double x = random.uniform(from + 0.2, to - 1.2);
    const double y = random.uniform(kAisle, kAisle + depth - 0.6);
    block(x, x + random.uniform(0.3, 1.0), y, y + random.uniform(0.2, 0.6), 0.0,
          random.uniform(0.4, 2.4), Material::wood);
  }
}

/// A wing along x from 0: an aisle between two rows of blocks.
Mesh make_wing(double block, double deepest, Random& random) {
  Mesh wing;
  const double length = kBlocks * block;
  const double outer = kAisle + deepest + kThin;
  add_block(wing, {-kThin, -outer, -kThin}, {length, outer, 0.0}, Material::concrete);
  add_block(wing, {-kThin, -outer, kOfficeCeiling}, {length, outer, kOfficeCeiling + kThin},
            Material::plaster);
  for (int i = 0; i < kBlocks; ++i) {
    for (const double side : {-1.0, 1.0}) {
      add_alcove(wing, i * block, (i + 1) * block, side, deepest, random);
    }
    const double lamp = (i + random.uniform(0.2, 0.6)) * block;
    add_block(wing, {lamp, -0.15, kOfficeCeiling - 0.1}, {lamp + 0.8, 0.15, kOfficeCeiling},
              Material::metal);
  }
  for (const double side : {-1.0, 1.0}) {
    add_block(wing, {-kThin, std::min(side * kAisle, side * outer), 0.0},
              {0.0, std::max(side * kAisle, side * outer), kOfficeCeiling}, Material::plaster);
  }
  return wing;
}

}  // namespace

Scene make_repeated_wing(uint64_t seed) {
  Random random(seed);
  Scene scene;
  const double block = random.uniform(2.4, 3.6);  // m along a wing
  const double length = kBlocks * block;
  const double between = random.uniform(200.0, 400.0);  // m, of corridors
  const double apart = random.uniform(kLeastAside, kMostAside * (between + length));
  const double deepest = std::min(4.5, 0.5 * apart - kAisle - 1.5 * kThin);
  // The corridors from the first wing's end round to the second wing's beginning.
  const double end = length + 4.0;  // both wings' ends meet in front of the first
  const double east = end + 8.0;
  const double west = -6.0;
  const double south = -0.5 * (between - (east - length) - (east - west) - apart + west);
  const Mesh wing = make_wing(block, deepest, random);
  add_copy(scene.mesh, wing, Vector3d::Zero());
  add_copy(scene.mesh, wing, {0.0, apart, 0.0});
  add_block(scene.mesh, {-2.0 * kThin, -kAisle, 0.0}, {-kThin, kAisle, kOfficeCeiling},
            Material::plaster);
  add_way(scene.mesh, {{length, 0.0}, {end - kHalfPassage, 0.0}}, random);
  add_corner(scene.mesh, {end, 0.0}, {-Vector2d::UnitX(), Vector2d::UnitX(), Vector2d::UnitY()});
  add_way(scene.mesh,
          {{end + kHalfPassage, 0.0},
           {east, 0.0},
           {east, south},
           {west, south},
           {west, apart},
           {-kThin, apart}},
          random);
  add_way(scene.mesh, {{length, apart}, {end, apart}, {end, kHalfPassage}}, random);
  // It begins where the second corner's rounding does.
  for (const Vector2d& corner :
       {Vector2d(1.2, 0.0), Vector2d(2.0, -0.35), Vector2d(length, -0.35), Vector2d(east, 0.0),
        Vector2d(east, south), Vector2d(west, south), Vector2d(west, apart), Vector2d(end, apart),
        Vector2d(end, 0.35), Vector2d(2.0, 0.35)}) {
    scene.route.emplace_back(corner.x(), corner.y(), 0.0);
  }
  scene.corner_radius = 1.5;
  scene.speed = 2.0;
  return scene;
}

}  // namespace adit
