// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A mine: rough drifts of 4.6 x 4.2 m around three pillars of rock, with junctions, and on the far
// side of the third a smooth, lined tunnel of 80 m in which nothing tells how far one has come.
#include <algorithm>
#include <array>
#include <cmath>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/simulator/scene.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalfWidth = 2.3;
constexpr double kWall = 2.0;     // m, where the wall turns into the arch
constexpr double kHeight = 4.2;   // m, at the middle
constexpr double kOverlap = 1.6;  // m that a drift goes on beyond its ends, into the junctions
constexpr double kStep = 0.35;    // m between vertices

struct Drift {
  Vector2d from;
  Vector2d to;
  bool smooth = false;
  double bend = 0.0;  ///< m, how far the middle lies off the straight line

  double length() const { return (to - from).norm(); }
};

const std::vector<Drift>& drifts() {
  static const std::vector<Drift> kDrifts{
      {{0, 0}, {25, 0}, false, 0.8},     {{25, 0}, {50, 0}, false, -0.7},
      {{50, 0}, {130, 0}, false, 3.0},   {{0, 0}, {0, 40}, false, -1.5},
      {{25, 0}, {25, 40}, false, 1.2},   {{50, 0}, {50, 40}, false, -1.0},
      {{130, 0}, {130, 40}, false, 1.6}, {{0, 40}, {25, 40}, false, 0.9},
      {{25, 40}, {50, 40}, false, -0.6}, {{50, 40}, {130, 40}, true, 0.0},
      {{50, 20}, {64, 26}, false, 0.3},  {{0, 22}, {-11, 18}, false, 0.4}};
  return kDrifts;
}

/// The floor's height: drifts follow the ore.
double grade(const Vector2d& at) {
  return 0.8 * repeatable_sin_cos(0.045 * at.x()).sin +
         0.6 * repeatable_sin_cos(0.07 * at.y() + 0.5).sin;
}

/// The centreline at a distance s (m) from its start; straight before and behind.
Vector2d centre(const Drift& drift, double s) {
  const Vector2d ahead = (drift.to - drift.from) / drift.length();
  const double u = std::clamp(s / drift.length(), 0.0, 1.0);
  const double half_wave = repeatable_sin_cos(kPi * u).sin;
  return drift.from + s * ahead +
         drift.bend * half_wave * half_wave * Vector2d(-ahead.y(), ahead.x());
}

/// The roof above the floor at a distance from the middle.
double roof(double across) {
  const double u = std::clamp(across / kHalfWidth, -1.0, 1.0);
  return kWall + (kHeight - kWall) * std::sqrt(1.0 - u * u);
}

/// How deep a point lies inside a drift (m), its floor apart; negative outside.
double depth_inside(const Drift& drift, const Vector3d& point) {
  const Vector2d ahead = (drift.to - drift.from) / drift.length();
  const Vector2d at = point.head<2>() - drift.from;
  const double s = at.dot(ahead);
  const Vector2d middle = centre(drift, s);
  const double across = (point.head<2>() - middle).dot(Vector2d(-ahead.y(), ahead.x()));
  const double height = point.z() - grade(point.head<2>());
  return std::min({kHalfWidth - std::abs(across), s + kOverlap, drift.length() + kOverlap - s,
                   roof(across) - height});
}

/// The outline of the cross-section, u from 0 to 1: floor from left to right, then wall, arch,
/// wall. Across and up (m).
Vector2d outline(double u) {
  constexpr double kFloor = 2.0 * kHalfWidth;
  constexpr double kArch = kPi * 0.5 * (kHalfWidth + kHeight - kWall);
  constexpr double kAround = kFloor + 2.0 * kWall + kArch;
  double s = u * kAround;
  if (s < kFloor) {
    return {-kHalfWidth + s, 0.0};
  }
  s -= kFloor;
  if (s < kWall) {
    return {kHalfWidth, s};
  }
  s -= kWall;
  if (s < kArch) {
    const SinCos angle = repeatable_sin_cos(kPi * s / kArch);
    return {kHalfWidth * angle.cos, kWall + (kHeight - kWall) * angle.sin};
  }
  return {-kHalfWidth, kWall - (s - kArch)};
}

/// Rock is uneven at several scales, a floor that is driven on less so.
Vector3d roughened(const Vector3d& point, const Vector3d& outwards, double height, uint64_t seed) {
  const double amount = height < 0.05 ? 0.25 : 1.0;
  const double offset = 0.28 * value_noise(0.4 * point, seed) +
                        0.16 * value_noise(1.1 * point, seed + 1) +
                        0.06 * value_noise(3.0 * point, seed + 2);
  return point + amount * offset * outwards;
}

/// Drops those triangles made from `first` on that would stand in another drift.
/// Floors stay: they lie on each other.
void open_junctions(Mesh& mesh, std::size_t first, const Drift& own) {
  constexpr double kMargin = 0.4;
  const auto blocks = [&](const Triangle& triangle) {
    const Vector3d a = mesh.vertices[triangle.corners[0]].cast<double>();
    const Vector3d b = mesh.vertices[triangle.corners[1]].cast<double>();
    const Vector3d c = mesh.vertices[triangle.corners[2]].cast<double>();
    const Vector3d middle = (a + b + c) / 3.0;
    const Vector3d normal = (b - a).cross(c - a);
    const bool lies = normal.z() * normal.z() > 0.5 * normal.squaredNorm();
    if (lies && middle.z() - grade(middle.head<2>()) < 1.0) {
      return false;
    }
    return std::ranges::any_of(drifts(), [&](const Drift& other) {
      return &other != &own && depth_inside(other, middle) > kMargin;
    });
  };
  const auto begin = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(first);
  mesh.triangles.erase(std::remove_if(begin, mesh.triangles.end(), blocks), mesh.triangles.end());
}

void add_drift(Mesh& mesh, const Drift& drift, uint64_t seed) {
  const std::size_t first = mesh.triangles.size();
  const double step = drift.smooth ? 2.0 * kStep : kStep;
  const int around = drift.smooth ? 60 : 44;
  const int along = static_cast<int>((drift.length() + 2.0 * kOverlap) / step);
  const Vector2d ahead = (drift.to - drift.from) / drift.length();
  const Vector2d left(-ahead.y(), ahead.x());
  const auto vertex = [&](double s, double u, double scale) {
    const Vector2d shape = scale * (outline(u) - Vector2d(0, 1.5)) + Vector2d(0, 1.5);
    const Vector2d middle = centre(drift, s);
    const Vector2d at = middle - shape.x() * left;
    const Vector3d point(at.x(), at.y(), grade(drift.smooth ? middle : at) + shape.y());
    if (drift.smooth) {
      return point;
    }
    Vector3d outwards(-shape.x() * left.x(), -shape.x() * left.y(), shape.y() - 1.5);
    return roughened(point, outwards.normalized(), shape.y(), seed);
  };
  const Material material = drift.smooth ? Material::concrete : Material::rock;
  add_patch(mesh, around, along, material, [&](int u, int v) {
    const double s = -kOverlap + (drift.length() + 2.0 * kOverlap) * v / along;
    return vertex(s, static_cast<double>(u % around) / around, 1.0);
  });
  for (const double end : {-kOverlap, drift.length() + kOverlap}) {
    constexpr int kRings = 6;
    add_patch(mesh, around, kRings, material, [&](int u, int v) {
      return vertex(end, static_cast<double>(u % around) / around, static_cast<double>(v) / kRings);
    });
  }
  open_junctions(mesh, first, drift);
}

/// Pipes along one wall, rock that came down, and now and then a box: as in drifts that are used.
void furnish(Mesh& mesh, const Drift& drift, Random& random) {
  if (drift.smooth) {
    return;
  }
  const Vector2d ahead = (drift.to - drift.from) / drift.length();
  const Vector2d left(-ahead.y(), ahead.x());
  const auto place = [&](double s, double across, double up) {
    const Vector2d at = centre(drift, s) + across * left;
    return Vector3d(at.x(), at.y(), grade(at) + up);
  };
  for (double s = 3.0; s + 5.0 < drift.length(); s += 2.0) {
    add_rod(mesh,
            {.from = place(s, 1.85, 2.3),
             .to = place(s + 2.0, 1.85, 2.3),
             .radius_from = 0.09,
             .radius_to = 0.09,
             .sides = 8},
            Material::metal);
  }
  for (double s = 4.0; s + 4.0 < drift.length(); s += random.uniform(2.0, 7.0)) {
    const double side = random.uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
    const double size = random.uniform(0.15, 0.5);
    if (random.uniform(0.0, 1.0) < 0.25) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = place(s, -1.6, 0.5);
      pose.linear() =
          rotation_from_yaw_pitch_roll(repeatable_atan2(ahead.y(), ahead.x()), 0.0, 0.0);
      add_movable(mesh, "box", [&] {
        add_box(mesh, pose, {random.uniform(0.3, 0.8), 0.3, 0.5}, Material::paint);
      });
    } else {
      add_movable(mesh, "rock", [&] {
        add_blob(mesh,
                 {.center = place(s, side * random.uniform(1.5, 2.0), 0.3 * size),
                  .radii = {size, size, 0.8 * size},
                  .roughness = 0.6,
                  .seed = static_cast<uint64_t>(1e6 * random.uniform(0.0, 1.0))},
                 Material::rock);
      });
    }
  }
}

}  // namespace

Scene make_mine(uint64_t seed) {
  Random random(seed);
  Scene scene;
  for (const Drift& drift : drifts()) {
    add_drift(scene.mesh, drift, 16 * seed);
    furnish(scene.mesh, drift, random);
  }
  // Each pillar of rock is gone round, the degenerate tunnel once.
  struct Leg {
    std::size_t drift;
    bool backwards;
  };
  constexpr std::array<Leg, 16> kLegs{{{0, false},
                                       {4, false},
                                       {7, true},
                                       {3, true},
                                       {0, false},
                                       {1, false},
                                       {5, false},
                                       {8, true},
                                       {4, true},
                                       {1, false},
                                       {2, false},
                                       {6, false},
                                       {9, true},
                                       {8, true},
                                       {7, true},
                                       {3, true}}};
  for (const Leg& leg : kLegs) {
    const Drift& drift = drifts()[leg.drift];
    constexpr int kParts = 8;
    for (int i = 0; i < kParts; ++i) {
      const double u = static_cast<double>(leg.backwards ? kParts - i : i) / kParts;
      const Vector2d at = centre(drift, u * drift.length());
      scene.route.emplace_back(at.x(), at.y(), grade(at));
    }
  }
  scene.corner_radius = 2.5;
  scene.speed = 1.6;
  scene.dust = 2e-4;
  return scene;
}

}  // namespace adit
