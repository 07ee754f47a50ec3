// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/ray_scene.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/scene.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

Mesh soup(int triangles, uint64_t seed) {
  const CounterRandom random(seed, RandomStream::scene);
  Mesh mesh;
  for (uint64_t i = 0; i < static_cast<uint64_t>(triangles); ++i) {
    const Vector3d center = 5.0 * random.gaussian_vector(4 * i);
    for (uint64_t k = 1; k < 4; ++k) {
      mesh.vertices.emplace_back((center + 0.6 * random.gaussian_vector(4 * i + k)).cast<float>());
    }
    const auto base = static_cast<uint32_t>(3 * i);
    mesh.triangles.push_back({{base, base + 1, base + 2}, Material::rock});
  }
  return mesh;
}

/// Solves for the point of the plane, then asks whether it is in the triangle: another way than
/// RayScene's, with every triangle tried.
double nearest_by_trying_all(const Mesh& mesh, const Vector3d& origin, const Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : mesh.triangles) {
    const Vector3d a = mesh.vertices[triangle.corners[0]].cast<double>();
    const Vector3d b = mesh.vertices[triangle.corners[1]].cast<double>();
    const Vector3d c = mesh.vertices[triangle.corners[2]].cast<double>();
    Eigen::Matrix3d system;
    system << b - a, c - a, -direction;
    const Vector3d solution = system.partialPivLu().solve(origin - a);
    if (solution.x() >= 0.0 && solution.y() >= 0.0 && solution.x() + solution.y() <= 1.0 &&
        solution.z() > 0.0) {
      nearest = std::min(nearest, solution.z());
    }
  }
  return nearest;
}

TEST(RayScene, FindsTheNearestOfAllTriangles) {
  const Mesh mesh = soup(800, 1);
  const RayScene scene(mesh);
  const CounterRandom random(2, RandomStream::scene);
  int hits = 0;
  for (uint64_t i = 0; i < 3000; ++i) {
    const Vector3d origin = 6.0 * random.gaussian_vector(2 * i);
    const Vector3d direction = random.gaussian_vector(2 * i + 1).normalized();
    const double expected = nearest_by_trying_all(mesh, origin, direction);
    const auto hit = scene.cast(origin, direction, 1e3);
    ASSERT_EQ(hit.has_value(), std::isfinite(expected)) << "ray " << i;
    if (hit) {
      ++hits;
      EXPECT_NEAR(hit->distance, expected, 1e-9 * (1.0 + expected));
      EXPECT_NEAR(hit->normal.norm(), 1.0, 1e-12);
      EXPECT_LE(hit->normal.dot(direction), 0.0);
    }
  }
  EXPECT_GT(hits, 500);
}

TEST(RayScene, RaysAlongTheAxesAndThroughEdgesHitABox) {
  Mesh mesh;
  add_block(mesh, {-1, -2, -3}, {1, 2, 3}, Material::metal);
  const RayScene scene(mesh);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vector3d direction = Vector3d::Zero();
      direction[axis] = side;
      const auto hit = scene.cast(-10.0 * direction, direction, 100.0);
      ASSERT_TRUE(hit);
      EXPECT_DOUBLE_EQ(hit->distance, 10.0 - (axis + 1));
      EXPECT_EQ(hit->material, Material::metal);
    }
  }
  // The diagonal of a face is an edge of two triangles: no ray gets through.
  for (int i = -99; i < 100; ++i) {
    const Vector3d on_diagonal(0.01 * i, 0.02 * i, 3.0);
    const Vector3d origin = on_diagonal + Vector3d(3.0, 1.0, 4.0);
    EXPECT_TRUE(scene.cast(origin, (on_diagonal - origin).normalized(), 100.0)) << i;
  }
}

TEST(RayScene, NothingIsHitBehindOrBeyondTheRange) {
  Mesh mesh;
  add_block(mesh, {5, -1, -1}, {6, 1, 1}, Material::metal);
  const RayScene scene(mesh);
  EXPECT_FALSE(scene.cast({0, 0, 0}, -Vector3d::UnitX(), 100.0));
  EXPECT_FALSE(scene.cast({0, 0, 0}, Vector3d::UnitX(), 4.999));
  EXPECT_TRUE(scene.cast({0, 0, 0}, Vector3d::UnitX(), 5.001));
  EXPECT_FALSE(RayScene(Mesh{}).cast({0, 0, 0}, Vector3d::UnitX(), 100.0));
}

TEST(RayScene, DistanceToTheSurface) {
  Mesh mesh;
  add_block(mesh, {-1, -1, -1}, {1, 1, 1}, Material::metal);
  const RayScene scene(mesh);
  EXPECT_NEAR(scene.distance_to({3, 0.2, 0.3}), 2.0, 1e-12);    // to a face
  EXPECT_NEAR(scene.distance_to({4, 5, 0}), 5.0, 1e-12);        // to an edge
  EXPECT_NEAR(scene.distance_to({3, 3, 2}), 3.0, 1e-12);        // to a corner
  EXPECT_NEAR(scene.distance_to({0.9, 0.0, 0.0}), 0.1, 1e-12);  // from within
}

TEST(Scenes, AreTheSameForTheSameSeedAndOthersForOthers) {
  for (const std::string& name : scene_names()) {
    const Scene one = make_scene(name, 1);
    const Scene two = make_scene(name, 1);
    ASSERT_EQ(one.mesh.vertices.size(), two.mesh.vertices.size());
    bool same = true;
    for (std::size_t i = 0; i < one.mesh.vertices.size(); ++i) {
      same = same && one.mesh.vertices[i] == two.mesh.vertices[i];
    }
    EXPECT_TRUE(same) << name;
    const Scene other = make_scene(name, 2);
    EXPECT_FALSE(
        one.mesh.vertices.size() == other.mesh.vertices.size() &&
        std::equal(one.mesh.vertices.begin(), one.mesh.vertices.end(), other.mesh.vertices.begin()))
        << name;
  }
}

/// What is seen in a wing along x from 0, of so many m, is seen `apart` from there as well.
void expect_alias(const Scene& made, const Vector3d& apart, double length) {
  const RayScene scene(made.mesh);
  for (int i = 0; i < 40; ++i) {
    const double angle = 0.37 * i;
    const Vector3d eye(1.0 + (length - 4.0) * i / 39.0, 0.2, 1.2);
    const Vector3d ahead(std::cos(angle), std::sin(angle), 0.2 * std::sin(3.1 * angle));
    const double range = std::min(7.0, std::min(eye.x(), length - eye.x()));  // within the wing
    const auto first = scene.cast(eye, ahead.normalized(), range);
    const auto second = scene.cast(eye + apart, ahead.normalized(), range);
    ASSERT_EQ(first.has_value(), second.has_value()) << i;
    if (first) {
      EXPECT_NEAR(first->distance, second->distance, 1e-4) << i;
    }
  }
}

TEST(Scenes, TheSecondWingLooksLikeTheFirst) {
  const Scene wings = make_scene("wings", 3);
  const Vector3d apart(0.0, wings.route[5].y(), 0.0);  // the corner where the second wing begins
  ASSERT_GT(apart.y(), 20.0);
  expect_alias(wings, apart, 44.0);
}

// The alias lies where an odometry that drifts by 5 % of its path may have it, and nothing is in
// the way of the route.
TEST(Scenes, TheRepeatedWingLiesWithinAFewPerCentOfThePath) {
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    const Scene made = make_scene("repeated_wing", seed);
    const Vector3d apart(0.0, made.route[6].y(), 0.0);
    const double length = made.route[2].x();
    expect_alias(made, apart, length);
    double path = 0.0;  // from the first wing's beginning to the second's
    for (std::size_t i = 1; i < 6; ++i) {
      path += (made.route[i + 1] - made.route[i]).norm();
    }
    EXPECT_GE(apart.y(), 10.0);
    EXPECT_LT(apart.y(), 0.05 * path);
    EXPECT_GT(apart.y(), 0.02 * path);
    const RayScene scene(made.mesh);
    for (std::size_t i = 0; i < made.route.size(); ++i) {
      const Vector3d eye = made.route[i] + Vector3d(0.0, 0.0, 1.0);
      const Vector3d way = made.route[(i + 1) % made.route.size()] - made.route[i];
      EXPECT_FALSE(scene.cast(eye, way.normalized(), way.norm())) << seed << " " << i;
    }
  }
}

}  // namespace
}  // namespace adit
