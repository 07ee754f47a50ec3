// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A street of equal houses, driven down and up again: every garden resembles the next one. Trees
// and parked cars differ, and so do the squares at both ends.
#include <algorithm>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/simulator/scene_street.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr double kCarriageway = 4.0;  // m, from the middle to the kerb
constexpr double kFront = 10.0;       // m, from the middle to the houses
constexpr double kSquare = 26.0;      // m, half the side of the squares at both ends
constexpr double kLane = 2.0;         // m to the right of the middle

/// A house with a porch, a bay, a chimney and a hedge, to the left of the street at x.
void add_house(Mesh& mesh, double x, double width, double side) {
  const auto block = [&](double x0, double x1, double y0, double y1, double low, double high,
                         Material material) {
    add_block(mesh, {x + x0, std::min(side * y0, side * y1), low},
              {x + x1, std::max(side * y0, side * y1), high}, material);
  };
  const double depth = 9.0;
  block(0.0, width, kFront, kFront + depth, 0.0, 5.5, Material::plaster);
  block(1.0, 3.2, kFront - 1.5, kFront, 0.0, 2.8, Material::paint);
  block(width - 3.4, width - 1.0, kFront - 0.8, kFront, 0.6, 2.6, Material::concrete);
  block(0.6, 1.4, kFront + 3.0, kFront + 3.8, 5.5, 7.2, Material::concrete);
  block(0.0, width - 2.5, kCarriageway + 2.6, kCarriageway + 3.0, 0.0, 1.1, Material::leaves);
}

void add_parked_car(Mesh& mesh, double x, double side, Random& random) {
  const double half = random.uniform(1.9, 2.5);
  const double y = side * (kCarriageway + 0.9);
  add_block(mesh, {x - half, y - 0.9, 0.25}, {x + half, y + 0.9, 1.1}, Material::metal);
  add_block(mesh, {x - 0.5 * half, y - 0.75, 1.1}, {x + 0.6 * half, y + 0.75, 1.6}, Material::dark);
}

/// Buildings around a square whose middle is at x; the street comes from the side of `towards`.
void add_square(Mesh& mesh, double x, double towards, Random& random) {
  for (double along = -kSquare; along < kSquare;) {
    const double width = random.uniform(5.0, 14.0);
    const double end = std::min(kSquare, along + width);
    for (const double side : {-1.0, 1.0}) {
      const double front = kSquare + random.uniform(0.0, 4.0);
      add_block(mesh, {x + along, std::min(side * front, side * (kSquare + 14.0)), 0.0},
                {x + end - 0.3, std::max(side * front, side * (kSquare + 14.0)),
                 random.uniform(4.0, 14.0)},
                Material::concrete);
    }
    const double back = kSquare + random.uniform(0.0, 4.0);
    add_block(
        mesh, {x - towards * back - (towards > 0.0 ? 14.0 : 0.0), along, 0.0},
        {x - towards * back + (towards > 0.0 ? 0.0 : 14.0), end - 0.3, random.uniform(4.0, 14.0)},
        Material::plaster);
    along = end;
  }
  for (int i = 0; i < 6; ++i) {
    add_street_tree(mesh, {x + random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0), 0.0}, random);
  }
}

}  // namespace

Scene make_equal_houses(uint64_t seed) {
  Random random(seed);
  Scene scene;
  const double width = random.uniform(9.0, 15.0);  // m, of a house
  const double every = width + random.uniform(2.0, 5.0);
  const int houses = static_cast<int>(random.uniform(180.0, 300.0) / every);
  const double length = houses * every;
  add_block(scene.mesh, {-2.0 * kSquare - 40.0, -kSquare - 40.0, -0.2},
            {length + 2.0 * kSquare + 40.0, kSquare + 40.0, 0.0}, Material::asphalt);
  for (int i = 0; i < houses; ++i) {
    for (const double side : {-1.0, 1.0}) {
      add_house(scene.mesh, i * every, width, side);
      if (random.uniform(0.0, 1.0) < 0.4) {
        add_street_tree(scene.mesh,
                        {i * every + random.uniform(1.0, every - 1.0), side * (kFront - 2.2), 0.0},
                        random);
      }
      if (random.uniform(0.0, 1.0) < 0.4) {
        add_parked_car(scene.mesh, i * every + random.uniform(2.0, every - 2.0), side, random);
      }
    }
  }
  add_square(scene.mesh, -kSquare, 1.0, random);
  add_square(scene.mesh, length + kSquare, -1.0, random);
  // Around the trees in the middle of both squares.
  constexpr double kRound = 12.0;
  for (const auto& [x, y] :
       {std::pair(0.0, -kLane), std::pair(length, -kLane),
        std::pair(length + kSquare - kRound, -kRound),
        std::pair(length + kSquare + kRound, -kRound), std::pair(length + kSquare + kRound, kRound),
        std::pair(length + kSquare - kRound, kRound), std::pair(length, kLane),
        std::pair(0.0, kLane), std::pair(-kSquare + kRound, kRound),
        std::pair(-kSquare - kRound, kRound), std::pair(-kSquare - kRound, -kRound),
        std::pair(-kSquare + kRound, -kRound)}) {
    scene.route.emplace_back(x, y, 0.0);
  }
  scene.corner_radius = 6.0;
  scene.speed = 6.0;
  return scene;
}

}  // namespace adit
