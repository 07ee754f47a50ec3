// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/mesh.hpp"

#include <cmath>
#include <utility>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

/// Two directions across a line.
std::array<Vector3d, 2> across(const Vector3d& axis) {
  const Vector3d helper = std::abs(axis.z()) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX();
  const Vector3d first = axis.cross(helper).normalized();
  return {first, axis.cross(first)};
}

}  // namespace

Optics optics_of(Material material) {
  switch (material) {
    case Material::concrete:
      return {.reflectivity = 0.35F, .color = {168, 166, 160}};
    case Material::rock:
      return {.reflectivity = 0.22F, .color = {128, 118, 106}};
    case Material::asphalt:
      return {.reflectivity = 0.12F, .color = {84, 86, 90}};
    case Material::soil:
      return {.reflectivity = 0.25F, .color = {136, 112, 84}};
    case Material::grass:
      return {.reflectivity = 0.45F, .color = {122, 156, 88}};
    case Material::bark:
      return {.reflectivity = 0.3F, .color = {110, 86, 66}};
    case Material::leaves:
      return {.reflectivity = 0.5F, .color = {76, 126, 66}};
    case Material::wood:
      return {.reflectivity = 0.55F, .color = {184, 144, 98}};
    case Material::plaster:
      return {.reflectivity = 0.75F, .color = {226, 220, 206}};
    case Material::paint:
      return {.reflectivity = 0.6F, .color = {176, 92, 78}};
    case Material::metal:
      return {.reflectivity = 0.4F, .color = {140, 150, 162}};
    case Material::dark:
      return {.reflectivity = 0.04F, .color = {44, 44, 50}};
    case Material::sign:
      return {.reflectivity = 0.98F, .color = {240, 206, 60}};
    case Material::glass:
      return {.reflectivity = 0.08F, .transmission = 0.9F, .color = {150, 200, 220}};
  }
  return {};
}

void add_movable(Mesh& mesh, std::string label, const std::function<void()>& add) {
  const std::size_t vertices = mesh.vertices.size();
  const std::size_t triangles = mesh.triangles.size();
  add();
  mesh.movable.push_back({.label = std::move(label),
                          .first_vertex = vertices,
                          .vertices = mesh.vertices.size() - vertices,
                          .first_triangle = triangles,
                          .triangles = mesh.triangles.size() - triangles});
}

void add_patch(Mesh& mesh, int columns, int rows, Material material,
               const std::function<Vector3d(int, int)>& at) {
  const auto base = static_cast<uint32_t>(mesh.vertices.size());
  for (int v = 0; v <= rows; ++v) {
    for (int u = 0; u <= columns; ++u) {
      mesh.vertices.emplace_back(at(u, v).cast<float>());
    }
  }
  const auto width = static_cast<uint32_t>(columns + 1);
  for (uint32_t v = 0; v < static_cast<uint32_t>(rows); ++v) {
    for (uint32_t u = 0; u < static_cast<uint32_t>(columns); ++u) {
      const uint32_t corner = base + v * width + u;
      mesh.triangles.push_back({{corner, corner + 1, corner + width + 1}, material});
      mesh.triangles.push_back({{corner, corner + width + 1, corner + width}, material});
    }
  }
}

void add_quad(Mesh& mesh, const std::array<Vector3d, 4>& corners, Material material) {
  const auto base = static_cast<uint32_t>(mesh.vertices.size());
  for (const Vector3d& corner : corners) {
    mesh.vertices.emplace_back(corner.cast<float>());
  }
  mesh.triangles.push_back({{base, base + 1, base + 2}, material});
  mesh.triangles.push_back({{base, base + 2, base + 3}, material});
}

void add_box(Mesh& mesh, const Eigen::Isometry3d& T_world_box, const Vector3d& half_size,
             Material material) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const int b = (axis + 1) % 3;
      const int c = (axis + 2) % 3;
      std::array<Vector3d, 4> corners;
      constexpr std::array<std::array<double, 2>, 4> kSigns{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
      for (std::size_t i = 0; i < 4; ++i) {
        Vector3d corner;
        corner[axis] = side * half_size[axis];
        corner[b] = kSigns[i][0] * half_size[b];
        corner[c] = kSigns[i][1] * half_size[c];
        corners[i] = T_world_box * corner;
      }
      add_quad(mesh, corners, material);
    }
  }
}

void add_block(Mesh& mesh, const Vector3d& low, const Vector3d& high, Material material) {
  Eigen::Isometry3d T_world_box = Eigen::Isometry3d::Identity();
  T_world_box.translation() = 0.5 * (low + high);
  add_box(mesh, T_world_box, 0.5 * (high - low), material);
}

void add_rod(Mesh& mesh, const Rod& rod, Material material) {
  const auto [right, up] = across((rod.to - rod.from).normalized());
  const std::array<Vector3d, 4> centers{rod.from, rod.from, rod.to, rod.to};
  const std::array<double, 4> radii{0.0, rod.radius_from, rod.radius_to, 0.0};
  add_patch(mesh, rod.sides, 3, material, [&, a = right, b = up](int u, int v) {
    const SinCos angle = repeatable_sin_cos(2.0 * kPi * (u % rod.sides) / rod.sides);
    const auto i = static_cast<std::size_t>(v);
    return Vector3d(centers[i] + radii[i] * (angle.cos * a + angle.sin * b));
  });
}

void add_blob(Mesh& mesh, const Blob& blob, Material material) {
  const int rows = (blob.sides + 1) / 2;
  add_patch(mesh, blob.sides, rows, material, [&](int u, int v) {
    const SinCos around = repeatable_sin_cos(2.0 * kPi * (u % blob.sides) / blob.sides);
    const SinCos up = repeatable_sin_cos(kPi * (static_cast<double>(v) / rows - 0.5));
    const Vector3d direction(up.cos * around.cos, up.cos * around.sin, up.sin);
    const double scale = 1.0 + blob.roughness * value_noise(2.5 * direction, blob.seed);
    return Vector3d(blob.center + scale * blob.radii.cwiseProduct(direction));
  });
}

double value_noise(const Vector3d& at, uint64_t seed) {
  const CounterRandom random(seed, RandomStream::scene);
  const Vector3d cell = at.array().floor();
  const Vector3d part = at - cell;
  const Vector3d weight =
      part.array() * part.array() * (3.0 - 2.0 * part.array());  // smooth at the cells' borders
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    uint64_t index = 0;
    double share = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const int step = (corner >> axis) & 1;
      index = index * 2097152U +
              static_cast<uint64_t>(static_cast<int64_t>(cell[axis]) + step + 1048576);
      share *= step == 1 ? weight[axis] : 1.0 - weight[axis];
    }
    sum += share * (2.0 * random.uniform(index) - 1.0);
  }
  return sum;
}

}  // namespace adit
