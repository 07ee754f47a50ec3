// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "adit/tools/simulator/mesh.hpp"

namespace adit {

struct RayHit {
  double distance = 0.0;   ///< m
  Eigen::Vector3d normal;  ///< the triangle's, unit length, against the ray
  Material material = Material::concrete;
};

/// A mesh to cast rays at: a hierarchy of boxes, four to a node, built by the surface area
/// heuristic (Wald 2007). The boxes only save work: which triangle is hit, and how far away, is
/// decided by sums and products of doubles in a fixed order, so hits are the same bits on every
/// machine.
class RayScene {
 public:
  explicit RayScene(const Mesh& mesh);

  /// The nearest hit on the ray within `max_distance` (m); of two at the same distance that on the
  /// triangle that comes first in the mesh. `direction` has unit length.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                             double max_distance) const;

  /// Distance (m) from a point to the surface.
  double distance_to(const Eigen::Vector3d& point) const;

  Eigen::AlignedBox3f bounds() const { return bounds_; }

 private:
  struct Face {
    std::array<Eigen::Vector3f, 3> corners;
    uint32_t index = 0;  ///< in the mesh
    Material material = Material::concrete;
  };
  /// Low and high sides of the children's boxes, by axis and child.
  struct Node {
    std::array<std::array<float, 4>, 3> low;
    std::array<std::array<float, 4>, 3> high;
    std::array<uint32_t, 4> child;  ///< node, or first face
    std::array<uint32_t, 4> faces;  ///< number in a leaf; 0: an inner node
  };
  struct Part {
    Eigen::AlignedBox3f box;
    uint32_t first = 0;
    uint32_t count = 0;
  };

  uint32_t build(const Part& part, std::vector<Eigen::Vector3f>& centers);
  std::array<Part, 2> split(const Part& part, std::vector<Eigen::Vector3f>& centers);
  Part part_of(uint32_t first, uint32_t count) const;

  std::vector<Face> faces_;
  std::vector<Node> nodes_;
  Eigen::AlignedBox3f bounds_;
  float padding_ = 0.0F;
};

}  // namespace adit
