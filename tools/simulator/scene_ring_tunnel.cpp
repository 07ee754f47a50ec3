// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A circular tunnel, lined with equal ribs. Every place resembles every other one, turned about the
// circle's centre; a few niches with cabinets differ.
#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalfWidth = 2.4;  // m
constexpr double kHeight = 4.6;     // m, at the middle
constexpr double kSpring = 2.0;     // m, where the wall becomes the arch
constexpr double kRibEvery = 6.0;   // m along the centreline
constexpr double kRib = 0.6;        // m, its length along the centreline
constexpr double kRibDepth = 0.25;  // m

/// Across and up (m) on the lining, u from 0 (left foot) to 1 (right foot).
Vector2d lining(double u, double depth) {
  const double half = kHalfWidth - depth;
  const double arch = kHeight - kSpring - depth;
  const double around = 2.0 * kSpring + kPi * half;
  const double s = u * around;
  if (s <= kSpring) {
    return {-half, s};
  }
  if (s >= around - kSpring) {
    return {half, around - s};
  }
  const SinCos angle = repeatable_sin_cos((s - kSpring) / half);
  return {-half * angle.cos, kSpring + arch * angle.sin};
}

/// A tunnel around the origin, its centreline on a circle.
struct Ring {
  double radius;  // m

  Vector3d at(double along, double across, double up) const {
    const SinCos angle = repeatable_sin_cos(along / radius);
    return {(radius - across) * angle.cos, (radius - across) * angle.sin, up};
  }
  double length() const { return 2.0 * kPi * radius; }
};

void add_lining(Mesh& mesh, const Ring& ring) {
  constexpr double kStep = 0.3;  // m, of which a rib has two
  constexpr int kAround = 24;
  const int along = static_cast<int>(std::lround(ring.length() / kStep));
  add_patch(mesh, along, kAround, Material::concrete, [&](int u, int v) {
    const double s = ring.length() * u / along;
    const Vector2d place =
        lining(static_cast<double>(v) / kAround, std::fmod(s, kRibEvery) < kRib ? kRibDepth : 0.0);
    return ring.at(s, place.x(), place.y());
  });
  add_patch(mesh, along / 2, 1, Material::asphalt, [&](int u, int v) {
    return ring.at(ring.length() * u / (along / 2), v == 0 ? -kHalfWidth : kHalfWidth, 0.0);
  });
}

/// Cabinets, a fan and a sign at one place of the tunnel.
void add_niche(Mesh& mesh, const Ring& ring, double along, Random& random) {
  Eigen::Isometry3d T_world_box = Eigen::Isometry3d::Identity();
  const auto place = [&](double ahead, double across, double up, const Vector3d& half,
                         Material material) {
    T_world_box.translation() = ring.at(along + ahead, across, up);
    T_world_box.linear() =
        rotation_from_yaw_pitch_roll((along + ahead) / ring.radius + 0.5 * kPi, 0.0, 0.0);
    add_box(mesh, T_world_box, half, material);
  };
  const double side = random.uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
  const double depth = random.uniform(0.3, 0.6);
  const double height = random.uniform(1.0, 2.2);
  place(0.0, side * (kHalfWidth - depth), 0.5 * height,
        {random.uniform(0.4, 1.5), depth, 0.5 * height}, Material::metal);
  place(random.uniform(2.0, 4.0), random.uniform(-0.8, 0.8), kHeight - 0.7, {1.2, 0.35, 0.35},
        Material::metal);
  place(random.uniform(-3.0, -1.5), -side * (kHalfWidth - 0.1), random.uniform(1.5, 2.2),
        {0.5, 0.05, 0.3}, Material::sign);
}

}  // namespace

Scene make_ring_tunnel(uint64_t seed) {
  Random random(seed);
  Scene scene;
  const int ribs = static_cast<int>(random.uniform(26.0, 44.0));
  const Ring ring{.radius = ribs * kRibEvery / (2.0 * kPi)};
  add_lining(scene.mesh, ring);
  for (double along = random.uniform(5.0, 30.0); along < ring.length() - 5.0;
       along += random.uniform(25.0, 60.0)) {
    add_niche(scene.mesh, ring, along, random);
  }
  constexpr int kCorners = 24;
  for (int i = 0; i < kCorners; ++i) {
    scene.route.push_back(ring.at(ring.length() * i / kCorners, 0.0, 0.0));
  }
  scene.corner_radius = 0.9 * ring.radius;
  scene.speed = 3.0;
  return scene;
}

}  // namespace adit
