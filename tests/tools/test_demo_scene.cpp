// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/demo_scene.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tools/random.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Ray ray(const Vector3d& origin, const Vector3d& direction) {
  return {origin, direction.normalized()};
}

constexpr double kTight = 1e-12;

TEST(DemoScene, RayHitsTheFaceOfABoxAtItsAnalyticDistance) {
  const Box box{.center = {10, 0, 1}, .half_size = {2, 3, 1}};
  EXPECT_NEAR(intersect(ray({0, 0, 1}, {1, 0, 0}), box).value(), 8.0, kTight);
  EXPECT_NEAR(intersect(ray({0, 2, 0}, {8, 0, 1}), box).value(), std::sqrt(65.0), kTight);
  EXPECT_FALSE(intersect(ray({0, 3.1, 1}, {1, 0, 0}), box));
  EXPECT_FALSE(intersect(ray({0, 0, 1}, {-1, 0, 0}), box)) << "the box is behind";
}

TEST(DemoScene, RayHitsTheEdgeOfATurnedBoxAtItsAnalyticDistance) {
  const double half = std::sqrt(0.5);
  const Box box{.center = {10, 0, 1}, .half_size = {1, 1, 1}, .ahead = {half, half}};
  EXPECT_NEAR(intersect(ray({0, 0, 1}, {1, 0, 0}), box).value(), 10.0 - std::sqrt(2.0), kTight);
  EXPECT_FALSE(intersect(ray({0, 1.5, 1}, {1, 0, 0}), box));
}

TEST(DemoScene, RayHitsSideAndTopOfACylinderAtItsAnalyticDistance) {
  const Cylinder pole{.center = {5, 0}, .radius = 0.5, .bottom = 0, .top = 2};
  EXPECT_NEAR(intersect(ray({0, 0, 1}, {1, 0, 0}), pole).value(), 4.5, kTight);
  EXPECT_NEAR(intersect(ray({0, 0.3, 1}, {1, 0, 0}), pole).value(), 4.6, kTight);
  EXPECT_NEAR(intersect(ray({5, 0, 7}, {0, 0, -1}), pole).value(), 5.0, kTight)
      << "from straight above";
  EXPECT_FALSE(intersect(ray({0, 0, 2.1}, {1, 0, 0}), pole)) << "over the top";
  EXPECT_FALSE(intersect(ray({0, 0.6, 1}, {1, 0, 0}), pole)) << "beside it";
  EXPECT_FALSE(intersect(ray({4, 0, 7}, {0, 0, -1}), pole)) << "vertical and outside";
}

TEST(DemoScene, RayHitsSphereAndGroundAtTheirAnalyticDistances) {
  const Sphere ball{.center = {0, 6, 3}, .radius = 1};
  EXPECT_NEAR(intersect(ray({0, 0, 3}, {0, 1, 0}), ball).value(), 5.0, kTight);
  EXPECT_FALSE(intersect(ray({0, 0, 3}, {0, -1, 0}), ball));
  EXPECT_NEAR(intersect_ground(ray({0, 0, 2}, {1, 0, -1})).value(), 2.0 * std::sqrt(2.0), kTight);
  EXPECT_FALSE(intersect_ground(ray({0, 0, 2}, {1, 0, 0})));
}

TEST(DemoScene, EveryHitLiesOnTheSurfaceAndNoHitIsNearerThanTheDistanceToTheShape) {
  Random random(7);
  const auto vector = [&](double size) {
    return Vector3d(random.uniform(-size, size), random.uniform(-size, size),
                    random.uniform(-size, size));
  };
  const auto check = [](const Ray& r, const auto& shape) {
    const auto hit = intersect(r, shape);
    if (!hit) {
      return 0;
    }
    EXPECT_NEAR(distance_to(r.origin + *hit * r.direction, shape), 0.0, 1e-9);
    EXPECT_GT(distance_to(r.origin + (*hit - 1e-6) * r.direction, shape), 0.0);
    EXPECT_GE(*hit, distance_to(r.origin, shape) - 1e-9);
    return 1;
  };
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d center = vector(3);
    const double yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
    const Vector3d origin = center + 9.0 * vector(1).normalized();
    const Ray r = ray(origin, center + vector(2) - origin);
    hits += check(r, Box{center, {random.uniform(1, 4), 2, 1}, {std::cos(yaw), std::sin(yaw)}});
    hits +=
        check(r, Cylinder{center.head<2>(), random.uniform(1, 3), center.z() - 1, center.z() + 2});
    hits += check(r, Sphere{center, random.uniform(1, 3)});
  }
  EXPECT_GT(hits, 2000);
}

TEST(DemoScene, ViewReturnsTheNearestOfAllObjects) {
  Random random(11);
  std::vector<SceneObject> objects;
  for (int i = 0; i < 60; ++i) {
    const Vector2d place(random.uniform(-30, 30), random.uniform(-30, 30));
    if (place.norm() < 5.0) {
      continue;
    }
    objects.push_back({.shape = Cylinder{place, 0.8, 0, 4}, .reflectivity = 0.1F});
    objects.push_back({.shape = Box{{place.y(), place.x(), 1}, {2, 1, 1}}, .reflectivity = 0.2F});
  }
  const Vector3d eye(0, 0, 1.5);
  const SceneView view(objects, eye, 25.0);
  for (int i = 0; i < 2000; ++i) {
    const double azimuth = random.uniform(0, 2 * std::numbers::pi);
    const Ray r = ray(eye, {std::cos(azimuth), std::sin(azimuth), random.uniform(-0.3, 0.2)});
    double nearest = intersect_ground(r).value_or(1e9);
    for (const SceneObject& object : objects) {
      const auto hit =
          std::visit([&](const auto& shape) { return intersect(r, shape); }, object.shape);
      nearest = std::min(nearest, hit.value_or(1e9));
    }
    const auto hit = view.cast(r.direction);
    ASSERT_EQ(hit.has_value(), nearest <= 25.0);
    if (hit) {
      EXPECT_EQ(hit->distance, nearest);
    }
  }
}

}  // namespace
}  // namespace adit
