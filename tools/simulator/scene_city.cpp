// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A city of 12 x 9 blocks of 100 x 80 m: houses, trees, lamps, parked and moving cars, people, and
// an underpass. Its route is 9 km long and closes loops of all sizes.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/simulator/scene_street.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kColumns = 12;
constexpr int kRows = 9;
constexpr double kBlockX = 100.0;
constexpr double kBlockY = 80.0;
constexpr double kStreet = 6.5;    // m, half the width between the kerbs
constexpr double kSidewalk = 3.5;  // m
constexpr double kLane = 2.0;      // m to the right of the middle

void add_house(Mesh& mesh, const Vector3d& low, const Vector3d& high, bool along_x,
               Random& random) {
  const double pick = random.uniform(0.0, 1.0);
  const Material material = pick < 0.4   ? Material::plaster
                            : pick < 0.7 ? Material::concrete
                                         : Material::paint;
  add_block(mesh, low, high, material);
  // Bays and balconies: facades are not flat.
  const double length = along_x ? high.x() - low.x() : high.y() - low.y();
  for (double s = random.uniform(1.0, 3.0); s + 2.0 < length; s += random.uniform(3.0, 5.0)) {
    for (double z = 3.2; z + 1.2 < high.z(); z += 3.0) {
      if (random.uniform(0.0, 1.0) < 0.35) {
        const double out = random.uniform(0.4, 1.1);
        Vector3d from = low - Vector3d(along_x ? -s : out, along_x ? out : -s, -z);
        Vector3d to = from + Vector3d(along_x ? 2.0 : high.x() - low.x() + 2.0 * out,
                                      along_x ? high.y() - low.y() + 2.0 * out : 2.0, 1.0);
        add_block(mesh, from, to, Material::metal);
      }
    }
  }
}

/// Body and cabin, its wheels left out; x ahead.
void add_car(Mesh& mesh, const Eigen::Isometry3d& T_world_car, double length) {
  Eigen::Isometry3d part = Eigen::Isometry3d::Identity();
  part.translation() = Vector3d(0.0, 0.0, 0.65);
  add_box(mesh, T_world_car * part, {0.5 * length, 0.9, 0.42}, Material::metal);
  part.translation() = Vector3d(-0.1 * length, 0.0, 1.3);
  add_box(mesh, T_world_car * part, {0.28 * length, 0.78, 0.3}, Material::dark);
}

Eigen::Isometry3d standing_at(const Vector3d& at, double yaw) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = at;
  pose.linear() = rotation_from_yaw_pitch_roll(yaw, 0.0, 0.0);
  return pose;
}

/// What stands on a block and along its sidewalks.
void add_block_of_houses(Mesh& mesh, const Vector2d& corner, Random& random) {
  const Vector3d low(corner.x() + kStreet, corner.y() + kStreet, 0.0);
  const Vector3d high(corner.x() + kBlockX - kStreet, corner.y() + kBlockY - kStreet, 0.14);
  add_block(mesh, low - Vector3d(0, 0, 0.2), high, Material::concrete);
  const double depth = 13.0;
  const double x0 = low.x() + kSidewalk;
  const double x1 = high.x() - kSidewalk;
  const double y0 = low.y() + kSidewalk;
  const double y1 = high.y() - kSidewalk;
  for (double x = x0; x + 6.0 < x1;) {
    const double width = std::min(random.uniform(10.0, 22.0), x1 - x);
    for (const bool north : {false, true}) {
      const double back = random.uniform(0.0, 3.0);
      const double height = random.uniform(6.0, 20.0);
      const double from = north ? y1 - depth : y0 + back;
      const double to = north ? y1 - back : y0 + depth;
      if (random.uniform(0.0, 1.0) < 0.9) {
        add_house(mesh, {x, from, 0.0}, {x + width - 0.5, to, height}, true, random);
      }
    }
    x += width + (random.uniform(0.0, 1.0) < 0.3 ? random.uniform(2.0, 6.0) : 0.0);
  }
  for (double y = y0 + depth + 2.0; y + 8.0 < y1 - depth; y += random.uniform(9.0, 16.0)) {
    for (const bool east : {false, true}) {
      const double back = random.uniform(0.0, 3.0);
      const double from = east ? x1 - depth : x0 + back;
      const double to = east ? x1 - back : x0 + depth;
      add_house(mesh, {from, y, 0.0}, {to, y + 8.0, random.uniform(5.0, 15.0)}, false, random);
    }
  }
  const auto beside_street = [&](double x, double y, double yaw) {
    const double kind = random.uniform(0.0, 1.0);
    if (kind < 0.35) {
      add_street_tree(mesh, {x, y, 0.14}, random);
    } else if (kind < 0.55) {
      add_rod(mesh,
              {.from = {x, y, 0.1},
               .to = {x, y, 6.5},
               .radius_from = 0.1,
               .radius_to = 0.07,
               .sides = 7},
              Material::metal);
    } else if (kind < 0.62) {
      add_block(mesh, {x - 0.35, y - 0.35, 1.9}, {x + 0.35, y + 0.35, 2.6}, Material::sign);
    }
    if (random.uniform(0.0, 1.0) < 0.55) {
      const SinCos way = repeatable_sin_cos(yaw);
      const Vector3d kerbside(x + 1.9 * way.sin, y - 1.9 * way.cos, 0.0);
      add_movable(mesh, "parked car",
                  [&] { add_car(mesh, standing_at(kerbside, yaw), random.uniform(3.8, 5.0)); });
    }
  };
  for (double x = low.x() + 5.0; x < high.x() - 5.0; x += random.uniform(6.0, 9.0)) {
    beside_street(x, low.y() + 0.6, 0.0);
    beside_street(x, high.y() - 0.6, std::numbers::pi);
  }
  for (double y = low.y() + 5.0; y < high.y() - 5.0; y += random.uniform(6.0, 9.0)) {
    beside_street(low.x() + 0.6, y, -0.5 * std::numbers::pi);
    beside_street(high.x() - 0.6, y, 0.5 * std::numbers::pi);
  }
}

/// Around a block, clockwise: a closed way of its own for each car and person.
MovingObject circling(std::string label, Mesh mesh, const Vector2d& corner, double inset,
                      double speed, double start) {
  const Vector2d low = corner + Vector2d::Constant(inset);
  const Vector2d high = corner + Vector2d(kBlockX - inset, kBlockY - inset);
  const auto pose = [low, high, speed, start](double time) {
    const double x = high.x() - low.x();
    const double y = high.y() - low.y();
    const double around = 2.0 * (x + y);
    double s = start * around + speed * time;
    s -= std::floor(s / around) * around;
    constexpr double kQuarter = 0.5 * std::numbers::pi;
    if (s < y) {
      return standing_at({low.x(), low.y() + s, 0.0}, kQuarter);
    }
    if (s < y + x) {
      return standing_at({low.x() + s - y, high.y(), 0.0}, 0.0);
    }
    if (s < 2.0 * y + x) {
      return standing_at({high.x(), high.y() - (s - y - x), 0.0}, -kQuarter);
    }
    return standing_at({high.x() - (s - 2.0 * y - x), low.y(), 0.0}, 2.0 * kQuarter);
  };
  return {.label = std::move(label), .mesh = std::move(mesh), .T_world_object = pose};
}

void add_traffic(Scene& scene, Random& random) {
  for (int column = 0; column < kColumns; ++column) {
    for (int row = 0; row < kRows; ++row) {
      const Vector2d corner(column * kBlockX, row * kBlockY);
      Mesh car;
      add_car(car, Eigen::Isometry3d::Identity(), random.uniform(3.8, 5.2));
      // They keep to the right, as the route does; out_of_the_way() sees to those that it meets.
      scene.moving.push_back(
          circling("car", car, corner, 2.2, random.uniform(4.0, 10.0), random.uniform(0.0, 1.0)));
      for (int i = 0; i < 2; ++i) {
        Mesh person;
        add_rod(person,
                {.from = {0, 0, 0.1},
                 .to = {0, 0, random.uniform(1.6, 1.9)},
                 .radius_from = 0.2,
                 .radius_to = 0.16,
                 .sides = 8},
                Material::paint);
        scene.moving.push_back(circling("pedestrian", person, corner, kStreet + 2.0,
                                        random.uniform(0.9, 1.8), random.uniform(0.0, 1.0)));
      }
    }
  }
}

void add_underpass(Mesh& mesh) {
  const double y = 4.0 * kBlockY;
  const double x0 = 5.2 * kBlockX;
  const double x1 = 5.8 * kBlockX;
  add_block(mesh, {x0, y - kStreet - 1.0, 5.0}, {x1, y + kStreet + 1.0, 6.2}, Material::concrete);
  for (const double side : {-1.0, 1.0}) {
    add_block(mesh, {x0, y + side * (kStreet + 0.5) - 0.5, 0.0},
              {x1, y + side * (kStreet + 0.5) + 0.5, 5.0}, Material::concrete);
  }
}

/// Corners of the way, in blocks; it keeps to the right of the streets.
constexpr std::array<std::array<int, 2>, 31> kWay{
    {{1, 1},  {4, 1},  {4, 3}, {1, 3}, {1, 1}, {8, 1}, {8, 4},  {3, 4},  {3, 7},  {6, 7},  {6, 4},
     {11, 4}, {11, 1}, {9, 1}, {9, 3}, {5, 3}, {5, 9}, {10, 9}, {10, 6}, {11, 6}, {11, 8}, {7, 8},
     {7, 5},  {9, 5},  {9, 2}, {6, 2}, {6, 6}, {2, 6}, {2, 8},  {1, 8},  {1, 5}}};

std::vector<Vector3d> way() {
  std::vector<Vector3d> route;
  const std::size_t n = kWay.size();
  const auto corner = [&](std::size_t i) {
    return Vector2d(kWay[i % n][0] * kBlockX, kWay[i % n][1] * kBlockY);
  };
  const auto right = [](const Vector2d& from, const Vector2d& to) {
    const Vector2d ahead = (to - from) / std::sqrt((to - from).squaredNorm());
    return Vector2d(kLane * ahead.y(), -kLane * ahead.x());
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2d before = right(corner(i + n - 1), corner(i));
    const Vector2d after = right(corner(i), corner(i + 1));
    const Vector2d at = corner(i) + before + (before == after ? Vector2d(0, 0) : after);
    route.emplace_back(at.x(), at.y(), 0.0);
  }
  return route;
}

}  // namespace

Scene make_city(uint64_t seed) {
  Random random(seed);
  Scene scene;
  const double margin = 60.0;
  constexpr int kTiles = 24;
  add_patch(scene.mesh, kTiles, kTiles, Material::asphalt, [&](int u, int v) {
    return Vector3d(-margin + (kColumns * kBlockX + 2.0 * margin) * u / kTiles,
                    -margin + (kRows * kBlockY + 2.0 * margin) * v / kTiles, 0.0);
  });
  for (int column = 0; column < kColumns; ++column) {
    for (int row = 0; row < kRows; ++row) {
      add_block_of_houses(scene.mesh, {column * kBlockX, row * kBlockY}, random);
    }
  }
  add_underpass(scene.mesh);
  add_traffic(scene, random);
  scene.route = way();
  scene.corner_radius = 8.0;
  scene.speed = 9.0;
  return scene;
}

}  // namespace adit
