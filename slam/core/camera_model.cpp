// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/camera_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

using Distortion = std::array<double, 8>;
using Ray = Eigen::Vector2d;  // x/z, y/z

/// What a perspective lens multiplies the radius by.
double radial_factor(double r2, const Distortion& d) {
  return (1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) /
         (1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])));
}

/// Where the lens shows what lies along the ray.
Ray distorted(const Ray& ray, const Distortion& d) {
  const double r2 = ray.squaredNorm();
  const double radial = radial_factor(r2, d);
  const double xy = ray.x() * ray.y();
  return {ray.x() * radial + 2.0 * d[2] * xy + d[3] * (r2 + 2.0 * ray.x() * ray.x()),
          ray.y() * radial + d[2] * (r2 + 2.0 * ray.y() * ray.y()) + 2.0 * d[3] * xy};
}

/// The ray that the lens shows there, by fixed-point iteration.
std::optional<Ray> undistorted(const Ray& seen, const Distortion& d) {
  constexpr int kMostSteps = 50;
  constexpr double kSmall = 1e-9;
  Ray ray = seen;
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps; ++step) {
    const Ray error = seen - distorted(ray, d);
    const double size = error.norm();
    if (size < kSmall) {
      return ray;
    }
    if (!(size < last)) {
      break;  // beyond what the lens shows
    }
    last = size;
    ray += error;
  }
  return std::nullopt;
}

/// The same by bisection of the radius, where the fixed point is not reached: lenses that bend
/// much. The tangential part, which is small, is taken off step by step.
std::optional<Ray> undistorted_slowly(const Ray& seen, double widest, const Distortion& d) {
  Distortion radial_only = d;
  radial_only[2] = 0.0;
  radial_only[3] = 0.0;
  Ray ray = Ray::Zero();
  constexpr int kSteps = 20;
  for (int step = 0; step < kSteps; ++step) {
    const Ray wanted = seen - (distorted(ray, d) - distorted(ray, radial_only));
    const double radius = wanted.norm();
    double low = 0.0;
    double high = widest;
    for (int bit = 0; bit < std::numeric_limits<double>::digits; ++bit) {
      const double middle = 0.5 * (low + high);
      (middle * radial_factor(middle * middle, d) < radius ? low : high) = middle;
    }
    ray = radius > 0.0 ? Ray(wanted * (0.5 * (low + high) / radius)) : Ray::Zero();
  }
  constexpr double kSmall = 1e-7;
  return (distorted(ray, d) - seen).norm() < kSmall ? std::optional(ray) : std::nullopt;
}

/// The radius at which a fisheye shows what is at an angle to the axis, of a focal length of 1.
double fisheye_radius(double angle, const Distortion& d) {
  const double a2 = angle * angle;
  return angle * (1.0 + a2 * (d[0] + a2 * (d[1] + a2 * (d[2] + a2 * d[3]))));
}

/// The angle up to `widest` that a fisheye shows at the radius, by bisection: it grows with it.
std::optional<double> fisheye_angle(double radius, double widest, const Distortion& d) {
  if (radius > fisheye_radius(widest, d)) {
    return std::nullopt;
  }
  double low = 0.0;
  double high = widest;
  for (int bit = 0; bit < std::numeric_limits<double>::digits; ++bit) {
    const double middle = 0.5 * (low + high);
    (fisheye_radius(middle, d) < radius ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double widest_radius(const CameraModel& camera) {
  constexpr double kWidestPerspective = 8.0;  // 83 degrees to the axis: no such lens sees farther
  constexpr int kSteps = 4096;
  const bool fisheye = camera.lens == Lens::fisheye;
  const double end = fisheye ? std::numbers::pi : kWidestPerspective;
  double before = 0.0;
  for (int step = 1; step <= kSteps; ++step) {
    const double radius = end * step / kSteps;
    const double seen = fisheye ? fisheye_radius(radius, camera.distortion)
                                : radius * radial_factor(radius * radius, camera.distortion);
    if (!(seen > before)) {
      return end * (step - 1) / kSteps;
    }
    before = seen;
  }
  return end;
}

CameraProjection::CameraProjection(const CameraModel& camera)
    : camera_(camera), widest_(widest_radius(camera)) {}

std::optional<Eigen::Vector2d> CameraProjection::pixel(const Eigen::Vector3d& point) const {
  Ray seen;
  if (camera_.lens == Lens::fisheye) {
    const double aside = point.head<2>().norm();
    const double angle = std::atan2(aside, point.z());
    if (!(angle <= widest_)) {
      return std::nullopt;
    }
    const double radius = fisheye_radius(angle, camera_.distortion);
    seen = aside > 0.0 ? Ray(point.head<2>() * (radius / aside)) : Ray(0.0, 0.0);
  } else {
    const Ray ray = point.head<2>() / point.z();
    if (!(point.z() > 0.0) || !(ray.norm() <= widest_)) {
      return std::nullopt;
    }
    seen = distorted(ray, camera_.distortion);
  }
  return Eigen::Vector2d(camera_.fx * seen.x() + camera_.cx, camera_.fy * seen.y() + camera_.cy);
}

std::optional<double> CameraProjection::angle(const Eigen::Vector2d& pixel) const {
  const Ray seen((pixel.x() - camera_.cx) / camera_.fx, (pixel.y() - camera_.cy) / camera_.fy);
  return fisheye_angle(seen.norm(), widest_, camera_.distortion);
}

std::optional<Eigen::Vector3d> CameraProjection::ray(const Eigen::Vector2d& pixel) const {
  const Ray seen((pixel.x() - camera_.cx) / camera_.fx, (pixel.y() - camera_.cy) / camera_.fy);
  if (camera_.lens == Lens::fisheye) {
    const double radius = seen.norm();
    const std::optional<double> to_axis = angle(pixel);
    if (!to_axis) {
      return std::nullopt;
    }
    const Ray aside = radius > 0.0 ? Ray(seen * (std::sin(*to_axis) / radius)) : Ray(0.0, 0.0);
    return Eigen::Vector3d(aside.x(), aside.y(), std::cos(*to_axis));
  }
  const bool distorts =
      std::ranges::any_of(camera_.distortion, [](double number) { return number != 0.0; });
  std::optional<Ray> ray = distorts ? undistorted(seen, camera_.distortion) : seen;
  if (!ray) {
    ray = undistorted_slowly(seen, widest_, camera_.distortion);
  }
  if (!ray || !(ray->norm() <= widest_)) {
    return std::nullopt;
  }
  return Eigen::Vector3d(ray->x(), ray->y(), 1.0).normalized();
}

}  // namespace adit
