// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/demo_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kGroundReflectivity = 0.2F;

/// The part of a ray inside of something convex: from `enter` to `leave` (m along the ray).
struct Interval {
  double enter = -kInfinity;
  double leave = kInfinity;
};

/// Cuts with the slab low <= origin + t direction <= high.
Interval cut(Interval part, double origin, double direction, double low, double high) {
  if (direction == 0.0) {
    return origin < low || origin > high ? Interval{kInfinity, -kInfinity} : part;
  }
  const double a = (low - origin) / direction;
  const double b = (high - origin) / direction;
  return {std::max(part.enter, std::min(a, b)), std::min(part.leave, std::max(a, b))};
}

std::optional<double> first_hit(const Interval& part) {
  if (part.enter > part.leave || part.enter <= 0.0) {
    return std::nullopt;
  }
  return part.enter;
}

/// Turns a vector of the world into the box's own axes.
Vector3d to_box_axes(const Box& box, const Vector3d& v) {
  const Vector2d& u = box.ahead;
  return {u.x() * v.x() + u.y() * v.y(), u.x() * v.y() - u.y() * v.x(), v.z()};
}

/// Solves |offset + t direction|^2 = radius^2 for the part of the line within the radius.
template <int N>
Interval within_radius(const Eigen::Matrix<double, N, 1>& offset,
                       const Eigen::Matrix<double, N, 1>& direction, double radius) {
  const double a = direction.squaredNorm();
  const double excess = offset.squaredNorm() - radius * radius;
  if (a == 0.0) return excess > 0.0 ? Interval{kInfinity, -kInfinity} : Interval{};
  const double b = offset.dot(direction);
  const double discriminant = b * b - a * excess;
  if (discriminant < 0.0) return {kInfinity, -kInfinity};
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

}  // namespace

std::optional<double> intersect(const Ray& ray, const Box& box) {
  const Vector3d origin = to_box_axes(box, ray.origin - box.center);
  const Vector3d direction = to_box_axes(box, ray.direction);
  Interval part;
  for (int axis = 0; axis < 3; ++axis) {
    part = cut(part, origin[axis], direction[axis], -box.half_size[axis], box.half_size[axis]);
  }
  return first_hit(part);
}

std::optional<double> intersect(const Ray& ray, const Cylinder& cylinder) {
  const Vector2d offset = ray.origin.head<2>() - cylinder.center;
  const Vector2d direction = ray.direction.head<2>();
  const Interval side = within_radius<2>(offset, direction, cylinder.radius);
  return first_hit(cut(side, ray.origin.z(), ray.direction.z(), cylinder.bottom, cylinder.top));
}

std::optional<double> intersect(const Ray& ray, const Sphere& sphere) {
  return first_hit(within_radius<3>(ray.origin - sphere.center, ray.direction, sphere.radius));
}

std::optional<double> intersect_ground(const Ray& ray) {
  if (ray.direction.z() >= 0.0) {
    return std::nullopt;
  }
  return -ray.origin.z() / ray.direction.z();
}

double distance_to(const Vector3d& point, const Box& box) {
  const Vector3d local = to_box_axes(box, point - box.center);
  return (local.cwiseAbs() - box.half_size).cwiseMax(0.0).norm();
}

double distance_to(const Vector3d& point, const Cylinder& cylinder) {
  const double radial = (point.head<2>() - cylinder.center).norm() - cylinder.radius;
  const double vertical = std::max(cylinder.bottom - point.z(), point.z() - cylinder.top);
  return std::hypot(std::max(radial, 0.0), std::max(vertical, 0.0));
}

double distance_to(const Vector3d& point, const Sphere& sphere) {
  return std::max((point - sphere.center).norm() - sphere.radius, 0.0);
}

Sphere bounding_sphere(const Box& box) {
  return {.center = box.center, .radius = box.half_size.norm()};
}

Sphere bounding_sphere(const Cylinder& cylinder) {
  const Vector3d center(cylinder.center.x(), cylinder.center.y(),
                        0.5 * (cylinder.bottom + cylinder.top));
  return {.center = center,
          .radius = std::hypot(cylinder.radius, 0.5 * (cylinder.top - cylinder.bottom))};
}

Sphere bounding_sphere(const Sphere& sphere) {
  return sphere;
}

SceneView::SceneView(const std::vector<SceneObject>& objects, const Vector3d& eye, double max_range)
    : eye_(eye), max_range_(max_range) {
  for (const SceneObject& object : objects) {
    const Candidate seen = candidate(object, eye);
    if (seen.nearest <= max_range) {
      candidates_.push_back(seen);
    }
  }
  std::ranges::stable_sort(candidates_, {}, &Candidate::nearest);
}

SceneView::Candidate SceneView::candidate(const SceneObject& object, const Vector3d& eye) {
  const auto nearest = [&](const auto& shape) { return distance_to(eye, shape); };
  const Sphere hull =
      std::visit([](const auto& shape) { return bounding_sphere(shape); }, object.shape);
  const Vector3d to_center = hull.center - eye;
  const double distance = to_center.norm();
  Candidate seen{.nearest = std::visit(nearest, object.shape),
                 .axis = Vector3d::UnitX(),
                 .cos_spread = -2.0,  // the eye is within the hull: every direction may hit
                 .object = &object};
  if (distance > hull.radius) {
    const double sine = hull.radius / distance;
    seen.axis = to_center / distance;
    seen.cos_spread = std::sqrt(1.0 - sine * sine) - 1e-9;
  }
  return seen;
}

std::optional<SceneHit> SceneView::cast(const Vector3d& direction) const {
  const Ray ray{.origin = eye_, .direction = direction};
  SceneHit best{.distance = max_range_, .reflectivity = 0.0F};
  bool found = false;
  if (const auto ground = intersect_ground(ray); ground && *ground <= best.distance) {
    best = {.distance = *ground, .reflectivity = kGroundReflectivity};
    found = true;
  }
  for (const Candidate& candidate : candidates_) {
    if (candidate.nearest > best.distance) {
      break;
    }
    if (direction.dot(candidate.axis) < candidate.cos_spread) {
      continue;
    }
    const auto distance = std::visit([&](const auto& shape) { return intersect(ray, shape); },
                                     candidate.object->shape);
    if (distance && *distance <= best.distance) {
      best = {.distance = *distance, .reflectivity = candidate.object->reflectivity};
      found = true;
    }
  }
  return found ? std::optional(best) : std::nullopt;
}

}  // namespace adit
