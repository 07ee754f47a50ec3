// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A furnished room of 12 x 9 x 3.2 m.
#include <numbers>

#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr double kLength = 12.0;
constexpr double kWidth = 9.0;
constexpr double kHeight = 3.2;

void add_table_parts(Mesh& mesh, const Vector3d& at, double length, double width) {
  const double top = 0.74;
  add_block(mesh, at + Vector3d(-0.5 * length, -0.5 * width, top),
            at + Vector3d(0.5 * length, 0.5 * width, top + 0.04), Material::wood);
  for (const double x : {-0.46, 0.46}) {
    for (const double y : {-0.44, 0.44}) {
      const Vector3d foot = at + Vector3d(x * length, y * width, 0.0);
      add_rod(mesh,
              {.from = foot,
               .to = foot + Vector3d(0, 0, top),
               .radius_from = 0.03,
               .radius_to = 0.03,
               .sides = 6},
              Material::metal);
    }
  }
}

void add_table(Mesh& mesh, const Vector3d& at, double length, double width) {
  add_movable(mesh, "table", [&] { add_table_parts(mesh, at, length, width); });
}

void add_shelf(Mesh& mesh, const Vector3d& low, const Vector3d& size, Random& random) {
  const Vector3d high = low + size;
  constexpr int kBoards = 5;
  for (int i = 0; i < kBoards; ++i) {
    const double z = low.z() + size.z() * i / (kBoards - 1);
    add_block(mesh, {low.x(), low.y(), z}, {high.x(), high.y(), z + 0.03}, Material::wood);
  }
  for (double x = low.x(); x < high.x() - 0.3; x += random.uniform(0.35, 0.7)) {
    for (int i = 0; i + 1 < kBoards; ++i) {
      const double z = low.z() + size.z() * i / (kBoards - 1) + 0.03;
      const double top = z + random.uniform(0.1, 0.36);
      add_block(mesh, {x, low.y() + 0.05, z}, {x + random.uniform(0.1, 0.3), high.y() - 0.05, top},
                random.uniform(0.0, 1.0) < 0.5 ? Material::paint : Material::dark);
    }
  }
}

}  // namespace

Scene make_room(uint64_t seed) {
  Random random(seed);
  Scene scene;
  Mesh& mesh = scene.mesh;
  const double x = 0.5 * kLength;
  const double y = 0.5 * kWidth;
  add_quad(mesh, {Vector3d(-x, -y, 0), {x, -y, 0}, {x, y, 0}, {-x, y, 0}}, Material::concrete);
  add_quad(mesh, {Vector3d(-x, -y, kHeight), {x, -y, kHeight}, {x, y, kHeight}, {-x, y, kHeight}},
           Material::plaster);
  add_quad(mesh, {Vector3d(-x, -y, 0), {x, -y, 0}, {x, -y, kHeight}, {-x, -y, kHeight}},
           Material::plaster);
  add_quad(mesh, {Vector3d(-x, -y, 0), {-x, y, 0}, {-x, y, kHeight}, {-x, -y, kHeight}},
           Material::plaster);
  add_quad(mesh, {Vector3d(x, -y, 0), {x, y, 0}, {x, y, kHeight}, {x, -y, kHeight}},
           Material::concrete);
  add_quad(mesh, {Vector3d(-x, y, 0), {x, y, 0}, {x, y, kHeight}, {-x, y, kHeight}},
           Material::plaster);
  // Pillars and beams.
  for (const double place : {-2.6, 3.1}) {
    add_block(mesh, {place - 0.2, -0.2, 0.0}, {place + 0.2, 0.2, kHeight}, Material::concrete);
    add_block(mesh, {place - 0.15, -y, kHeight - 0.3}, {place + 0.15, y, kHeight},
              Material::concrete);
  }
  add_shelf(mesh, {-4.5, y - 0.45, 0.0}, {3.6, 0.4, 2.1}, random);
  add_shelf(mesh, {1.0, -y + 0.05, 0.0}, {2.4, 0.4, 1.7}, random);
  add_movable(mesh, "cabinet", [&] {
    add_block(mesh, {x - 0.7, -3.2, 0.0}, {x - 0.05, -2.0, 1.95}, Material::metal);
  });
  add_block(mesh, {-x + 0.02, -1.2, 0.0}, {-x + 0.08, -0.2, 2.05}, Material::paint);
  add_block(mesh, {2.0, y - 0.06, 0.9}, {4.4, y - 0.02, 2.2}, Material::dark);
  add_table(mesh, {-4.6, -3.2, 0.0}, 1.8, 0.8);
  add_table(mesh, {0.3, 0.6, 0.0}, 2.2, 1.0);
  add_table(mesh, {4.7, 3.1, 0.0}, 1.6, 0.8);
  for (int i = 0; i < 9; ++i) {
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const SinCos direction = repeatable_sin_cos(angle);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const Vector3d half(random.uniform(0.15, 0.4), random.uniform(0.15, 0.4),
                        random.uniform(0.2, 0.5));
    pose.linear() = rotation_from_yaw_pitch_roll(random.uniform(0.0, 1.5), 0.0, 0.0);
    pose.translation() = Vector3d(5.2 * direction.cos, 3.9 * direction.sin, half.z());
    add_movable(mesh, "box",
                [&] { add_box(mesh, pose, half, i % 3 == 0 ? Material::paint : Material::wood); });
  }
  add_movable(mesh, "plant", [&] {
    add_blob(mesh,
             {.center = {5.2, -0.4, 0.9},
              .radii = {0.35, 0.35, 0.6},
              .roughness = 0.5,
              .seed = seed,
              .sides = 14},
             Material::leaves);
  });
  scene.route = {{-3.8, -2.2, 0}, {0.2, -2.4, 0}, {4.0, -1.6, 0}, {4.1, 1.2, 0},
                 {2.0, 2.4, 0},   {-1.5, 2.5, 0}, {-4.1, 1.8, 0}};
  scene.corner_radius = 1.2;
  scene.speed = 0.8;
  return scene;
}

}  // namespace adit
