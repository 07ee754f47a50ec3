// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A forest of 240 x 240 m, and a field of 500 x 500 m with a barn, a fence and little else.
#include <algorithm>
#include <cmath>
#include <limits>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Hills of two scales.
struct Terrain {
  double height = 0.0;   ///< m, of the large hills
  double length = 60.0;  ///< m, their size
  double bumps = 0.1;    ///< m, of what is a metre or two wide
  uint64_t seed = 0;

  double at(double x, double y) const {
    return height * value_noise({x / length, y / length, 0.5}, seed) +
           bumps * value_noise({x / 1.7, y / 1.7, 0.5}, seed + 1);
  }
};

void add_ground(Mesh& mesh, const Terrain& terrain, double half, double step, Material material) {
  const int count = static_cast<int>(2.0 * half / step);
  add_patch(mesh, count, count, material, [&](int u, int v) {
    const double x = -half + step * u;
    const double y = -half + step * v;
    return Vector3d(x, y, terrain.at(x, y));
  });
}

/// A closed way that winds around the origin.
std::vector<Vector3d> winding_route(const Terrain& terrain, double radius, double waviness,
                                    int waves) {
  std::vector<Vector3d> route;
  constexpr int kCorners = 48;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * kPi * i / kCorners;
    const double r = radius * (1.0 + waviness * repeatable_sin_cos(waves * angle).sin +
                               0.5 * waviness * repeatable_sin_cos((waves + 2) * angle + 1.0).sin);
    const SinCos direction = repeatable_sin_cos(angle);
    const double x = r * direction.cos;
    const double y = r * direction.sin;
    route.emplace_back(x, y, terrain.at(x, y));
  }
  return route;
}

double distance_to_route(const std::vector<Vector3d>& route, const Vector2d& at) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < route.size(); ++i) {
    const Vector2d from = route[i].head<2>();
    const Vector2d edge = route[(i + 1) % route.size()].head<2>() - from;
    const double u = std::clamp((at - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, std::sqrt((at - from - u * edge).squaredNorm()));
  }
  return nearest;
}

void add_tree(Mesh& mesh, const Vector3d& foot, Random& random) {
  const double height = random.uniform(7.0, 16.0);
  const double radius = random.uniform(0.1, 0.28);
  const Vector3d top =
      foot + Vector3d(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), height);
  add_rod(mesh,
          {.from = foot - Vector3d(0, 0, 0.3),
           .to = top,
           .radius_from = radius,
           .radius_to = 0.3 * radius,
           .sides = 8},
          Material::bark);
  for (int i = 0; i < 3; ++i) {
    const Vector3d center = foot + Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                                            height * random.uniform(0.55, 0.95));
    add_blob(
        mesh,
        {.center = center,
         .radii = {random.uniform(0.8, 1.9), random.uniform(0.8, 1.9), random.uniform(0.7, 1.5)},
         .roughness = 0.6,
         .seed = static_cast<uint64_t>(random.uniform(0.0, 1e9)),
         .sides = 8},
        Material::leaves);
  }
}

void add_bush(Mesh& mesh, const Vector3d& foot, Random& random) {
  const double size = random.uniform(0.25, 0.9);
  add_blob(mesh,
           {.center = foot + Vector3d(0, 0, 0.5 * size),
            .radii = {size, size, 0.8 * size},
            .roughness = 0.7,
            .seed = static_cast<uint64_t>(random.uniform(0.0, 1e9)),
            .sides = 8},
           Material::leaves);
}

}  // namespace

Scene make_forest(uint64_t seed) {
  Random random(seed);
  Scene scene;
  const Terrain terrain{.height = 5.0, .length = 55.0, .bumps = 0.12, .seed = 8 * seed};
  constexpr double kHalf = 120.0;
  add_ground(scene.mesh, terrain, kHalf, 0.8, Material::soil);
  scene.route = winding_route(terrain, 62.0, 0.2, 3);
  for (int i = 0; i < 2600; ++i) {
    const Vector2d at(random.uniform(-kHalf, kHalf), random.uniform(-kHalf, kHalf));
    const double free = distance_to_route(scene.route, at);
    const Vector3d foot(at.x(), at.y(), terrain.at(at.x(), at.y()));
    const double kind = random.uniform(0.0, 1.0);
    if (kind < 0.6 && free > 2.0) {
      add_tree(scene.mesh, foot, random);
    } else if (kind < 0.95 && free > 1.8) {
      add_bush(scene.mesh, foot, random);
    } else if (free > 4.5) {
      const SinCos way = repeatable_sin_cos(random.uniform(0.0, kPi));
      const Vector3d half(2.5 * way.cos, 2.5 * way.sin, 0.0);
      add_rod(scene.mesh,
              {.from = foot - half + Vector3d(0, 0, 0.2),
               .to = foot + half + Vector3d(0, 0, 0.3),
               .radius_from = 0.22,
               .radius_to = 0.15,
               .sides = 8},
              Material::bark);
    }
  }
  scene.corner_radius = 3.0;
  scene.speed = 1.4;
  return scene;
}

Scene make_field(uint64_t seed) {
  Random random(seed);
  Scene scene;
  const Terrain terrain{.height = 3.0, .length = 90.0, .bumps = 0.05, .seed = 8 * seed + 4};
  add_ground(scene.mesh, terrain, 250.0, 1.5, Material::grass);
  scene.route = winding_route(terrain, 95.0, 0.12, 2);
  const auto on_ground = [&](double x, double y) { return Vector3d(x, y, terrain.at(x, y)); };
  const Vector3d barn = on_ground(30.0, 20.0);
  add_block(scene.mesh, barn + Vector3d(-9, -5, -1), barn + Vector3d(9, 5, 4), Material::wood);
  for (const double side : {-1.0, 1.0}) {
    add_quad(scene.mesh,
             {Vector3d(barn + Vector3d(-9.5, side * 5.6, 3.8)),
              Vector3d(barn + Vector3d(9.5, side * 5.6, 3.8)),
              Vector3d(barn + Vector3d(9.5, 0, 7.5)), Vector3d(barn + Vector3d(-9.5, 0, 7.5))},
             Material::paint);
  }
  for (int i = 0; i < 60; ++i) {
    const Vector3d foot = on_ground(-150.0 + 5.0 * i, 128.0);
    add_rod(scene.mesh,
            {.from = foot - Vector3d(0, 0, 0.2),
             .to = foot + Vector3d(0, 0, 1.3),
             .radius_from = 0.06,
             .radius_to = 0.06,
             .sides = 6},
            Material::wood);
  }
  for (int i = 0; i < 24; ++i) {
    const Vector2d at(random.uniform(-200.0, 200.0), random.uniform(-200.0, 200.0));
    const double free = distance_to_route(scene.route, at);
    if (free > 12.0 && (at - barn.head<2>()).squaredNorm() > 400.0) {
      add_tree(scene.mesh, on_ground(at.x(), at.y()), random);
    }
  }
  for (int i = 0; i < 40; ++i) {
    const Vector2d at(random.uniform(-150.0, 150.0), random.uniform(-150.0, 150.0));
    if (distance_to_route(scene.route, at) > 3.0) {
      add_bush(scene.mesh, on_ground(at.x(), at.y()), random);
    }
  }
  scene.corner_radius = 5.0;
  scene.speed = 3.0;
  return scene;
}

}  // namespace adit
