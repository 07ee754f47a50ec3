// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_passages.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "adit/tools/simulator/scene_office.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNarrowest = 1.0;  // m, from its middle to a wall
constexpr double kWidest = 2.2;
constexpr double kThin = 0.2;  // m, of floors and ceilings

/// Places of a straight passage: m along it from where it begins, and m to the left of its middle.
struct Frame {
  Vector2d origin;
  Vector2d ahead;

  Vector3d at(double along, double across, double z) const {
    const Vector2d left(-ahead.y(), ahead.x());
    const Vector2d place = origin + along * ahead + across * left;
    return {place.x(), place.y(), z};
  }
  void add(Mesh& mesh, const Vector3d& from, const Vector3d& to, Material material) const {
    const Vector3d a = at(from.x(), from.y(), from.z());
    const Vector3d b = at(to.x(), to.y(), to.z());
    add_block(mesh, a.cwiseMin(b), a.cwiseMax(b), material);
  }
};

/// Straight, from one end to the other: bays of their own length and width, with what stands there.
void add_passage(Mesh& mesh, const Vector2d& from, const Vector2d& to, Random& random) {
  const double length = (to - from).norm();
  const Frame frame{.origin = from, .ahead = (to - from) / length};
  frame.add(mesh, {0.0, -kHalfPassage, -kThin}, {length, kHalfPassage, 0.0}, Material::concrete);
  frame.add(mesh, {0.0, -kHalfPassage, kOfficeCeiling},
            {length, kHalfPassage, kOfficeCeiling + kThin}, Material::plaster);
  for (double along = 0.0; along < length;) {
    const double end = std::min(length, along + random.uniform(2.0, 7.0));
    for (const double side : {-1.0, 1.0}) {
      const double wall = random.uniform(kNarrowest, kWidest);
      frame.add(mesh, {along, side * wall, 0.0}, {end, side * kHalfPassage, kOfficeCeiling},
                random.uniform(0.0, 1.0) < 0.5 ? Material::plaster : Material::concrete);
      const double room = wall - kNarrowest;  // m, that leave the way free
      if (room > 0.2 && random.uniform(0.0, 1.0) < 0.7) {
        const double begin = random.uniform(along, end - 0.5);
        frame.add(mesh, {begin, side * (wall - random.uniform(0.1, room)), 0.0},
                  {std::min(end, begin + random.uniform(0.3, 2.0)), side * wall,
                   random.uniform(0.4, 2.6)},
                  random.uniform(0.0, 1.0) < 0.5 ? Material::wood : Material::metal);
      }
    }
    const double lamp = random.uniform(along, end);
    frame.add(mesh, {lamp, -0.15, kOfficeCeiling - random.uniform(0.05, 0.4)},
              {lamp + random.uniform(0.3, 1.4), 0.15, kOfficeCeiling}, Material::metal);
    along = end;
  }
}

}  // namespace

void add_corner(Mesh& mesh, const Vector2d& corner, const std::vector<Vector2d>& open) {
  const auto block = [&](const Vector2d& middle, const Vector2d& half, double low, double high,
                         Material material) {
    const Vector2d a = middle - half;
    const Vector2d b = middle + half;
    add_block(mesh, {a.x(), a.y(), low}, {b.x(), b.y(), high}, material);
  };
  const Vector2d square(kHalfPassage, kHalfPassage);
  block(corner, square, -kThin, 0.0, Material::concrete);
  block(corner, square, kOfficeCeiling, kOfficeCeiling + kThin, Material::plaster);
  for (const Vector2d& side : {Vector2d(1, 0), Vector2d(-1, 0), Vector2d(0, 1), Vector2d(0, -1)}) {
    if (std::ranges::any_of(open, [&](const Vector2d& to) { return side.dot(to) > 0.5; })) {
      continue;
    }
    const Vector2d across(std::abs(side.y()), std::abs(side.x()));
    block(corner + (kHalfPassage - 0.5 * kThin) * side,
          kHalfPassage * across + 0.5 * kThin * side.cwiseAbs(), 0.0, kOfficeCeiling,
          Material::plaster);
  }
}

void add_way(Mesh& mesh, const std::vector<Vector2d>& corners, Random& random) {
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const Vector2d ahead = (corners[i + 1] - corners[i]).normalized();
    const bool turns = i + 2 < corners.size();
    const Vector2d from = corners[i] + (i > 0 ? kHalfPassage : 0.0) * ahead;
    add_passage(mesh, from, corners[i + 1] - (turns ? kHalfPassage : 0.0) * ahead, random);
    if (turns) {
      add_corner(mesh, corners[i + 1], {-ahead, (corners[i + 2] - corners[i + 1]).normalized()});
    }
  }
}

void add_copy(Mesh& mesh, const Mesh& other, const Vector3d& offset) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  const std::size_t first_triangle = mesh.triangles.size();
  for (const Eigen::Vector3f& vertex : other.vertices) {
    mesh.vertices.emplace_back(vertex + offset.cast<float>());
  }
  for (Triangle triangle : other.triangles) {
    for (uint32_t& corner : triangle.corners) {
      corner += first;
    }
    mesh.triangles.push_back(triangle);
  }
  for (MeshPart part : other.movable) {
    part.first_vertex += first;
    part.first_triangle += first_triangle;
    mesh.movable.push_back(part);
  }
}

}  // namespace adit
