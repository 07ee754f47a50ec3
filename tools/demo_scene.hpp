// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A world made of simple shapes, in which distances along rays have closed forms.
// Frame: world, metres, z up, the ground is the plane z = 0.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace adit {

struct Ray {
  Eigen::Vector3d origin;     ///< world, m
  Eigen::Vector3d direction;  ///< world, unit length
};

/// A box that stands upright. `ahead` is the direction of its own x axis in the ground plane, unit
/// length.
struct Box {
  Eigen::Vector3d center;
  Eigen::Vector3d half_size;
  Eigen::Vector2d ahead{1.0, 0.0};
};

/// A vertical cylinder, closed at both ends.
struct Cylinder {
  Eigen::Vector2d center;
  double radius = 0.0;
  double bottom = 0.0;
  double top = 0.0;
};

struct Sphere {
  Eigen::Vector3d center;
  double radius = 0.0;
};

using Shape = std::variant<Box, Cylinder, Sphere>;

/// Distance (m) along the ray to the first point of the surface in front of the origin, which lies
/// outside of the shape; nothing where the ray misses.
std::optional<double> intersect(const Ray& ray, const Box& box);
std::optional<double> intersect(const Ray& ray, const Cylinder& cylinder);
std::optional<double> intersect(const Ray& ray, const Sphere& sphere);
std::optional<double> intersect_ground(const Ray& ray);

/// Distance (m) from a point to a shape; 0 inside.
double distance_to(const Eigen::Vector3d& point, const Box& box);
double distance_to(const Eigen::Vector3d& point, const Cylinder& cylinder);
double distance_to(const Eigen::Vector3d& point, const Sphere& sphere);

/// A sphere that holds the shape.
Sphere bounding_sphere(const Box& box);
Sphere bounding_sphere(const Cylinder& cylinder);
Sphere bounding_sphere(const Sphere& sphere);

struct SceneObject {
  Shape shape;
  float reflectivity = 0.5F;  ///< 0 to 1, becomes the intensity of a return
};

struct SceneHit {
  double distance = 0.0;  ///< m
  float reflectivity = 0.0F;
};

/// What can be seen from one place, the nearest objects first, so that most rays end after few
/// tests. The objects must outlive the view.
class SceneView {
 public:
  SceneView(const std::vector<SceneObject>& objects, const Eigen::Vector3d& eye, double max_range);

  /// The first hit in a direction (unit length) within the range. The ground is always there.
  std::optional<SceneHit> cast(const Eigen::Vector3d& direction) const;

 private:
  struct Candidate {
    double nearest = 0.0;     ///< m, no hit can be nearer than this
    Eigen::Vector3d axis;     ///< the cone from the eye that holds the object: its unit axis
    double cos_spread = 0.0;  ///< and the cosine of its half angle
    const SceneObject* object = nullptr;
  };

  static Candidate candidate(const SceneObject& object, const Eigen::Vector3d& eye);

  Eigen::Vector3d eye_;
  double max_range_;
  std::vector<Candidate> candidates_;
};

}  // namespace adit
