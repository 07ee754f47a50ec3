// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/ray_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace adit {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr uint32_t kLeafFaces = 4;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kStackSize = 256;

double area(const Eigen::AlignedBox3f& box) {
  if (box.isEmpty()) {
    return 0.0;
  }
  const Vector3d size = box.sizes().cast<double>();
  return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

/// Möller and Trumbore's test (1997). Corners and edges belong to the triangle.
std::optional<double> distance_along(const Vector3d& origin, const Vector3d& direction,
                                     const Vector3d& a, const Vector3d& ab, const Vector3d& ac) {
  constexpr double kEdge = 1e-11;
  const Vector3d p = direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0.0) {
    return std::nullopt;
  }
  const double inverse = 1.0 / determinant;
  const Vector3d from = origin - a;
  const double u = from.dot(p) * inverse;
  if (u < -kEdge || u > 1.0 + kEdge) {
    return std::nullopt;
  }
  const Vector3d q = from.cross(ab);
  const double v = direction.dot(q) * inverse;
  if (v < -kEdge || u + v > 1.0 + kEdge) {
    return std::nullopt;
  }
  const double t = ac.dot(q) * inverse;
  return t > 0.0 ? std::optional(t) : std::nullopt;
}

/// Squared distance from a point to a triangle (Ericson 2005, section 5.1.5).
double squared_distance(const Vector3d& p, const std::array<Vector3f, 3>& corners) {
  const Vector3d a = corners[0].cast<double>();
  const Vector3d b = corners[1].cast<double>();
  const Vector3d c = corners[2].cast<double>();
  const Vector3d normal = (b - a).cross(c - a);
  const auto left_of = [&](const Vector3d& from, const Vector3d& to) {
    return (to - from).cross(p - from).dot(normal) >= 0.0;
  };
  if (left_of(a, b) && left_of(b, c) && left_of(c, a) && normal.squaredNorm() > 0.0) {
    const double off = (p - a).dot(normal);
    return off * off / normal.squaredNorm();
  }
  const auto to_edge = [&](const Vector3d& from, const Vector3d& to) {
    const Vector3d edge = to - from;
    const double length = edge.squaredNorm();
    const double u = length > 0.0 ? std::clamp((p - from).dot(edge) / length, 0.0, 1.0) : 0.0;
    return (p - from - u * edge).squaredNorm();
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

}  // namespace

RayScene::RayScene(const Mesh& mesh) {
  faces_.reserve(mesh.triangles.size());
  std::vector<Vector3f> centers;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& triangle = mesh.triangles[i];
    Face face{.corners = {}, .index = static_cast<uint32_t>(i), .material = triangle.material};
    for (std::size_t k = 0; k < 3; ++k) {
      face.corners[k] = mesh.vertices[triangle.corners[k]];
      bounds_.extend(face.corners[k]);
    }
    faces_.push_back(face);
    centers.emplace_back((face.corners[0] + face.corners[1] + face.corners[2]) / 3.0F);
  }
  if (faces_.empty()) {
    return;
  }
  // Covers the rounding of rays to float, so that no box is missed whose triangle is hit.
  padding_ =
      1e-6F * std::max(bounds_.min().cwiseAbs().maxCoeff(), bounds_.max().cwiseAbs().maxCoeff()) +
      1e-6F;
  build(part_of(0, static_cast<uint32_t>(faces_.size())), centers);
}

RayScene::Part RayScene::part_of(uint32_t first, uint32_t count) const {
  Part part{.box = {}, .first = first, .count = count};
  for (uint32_t i = first; i < first + count; ++i) {
    for (const Vector3f& corner : faces_[i].corners) {
      part.box.extend(corner);
    }
  }
  return part;
}

std::array<RayScene::Part, 2> RayScene::split(const Part& part, std::vector<Vector3f>& centers) {
  constexpr int kBins = 16;
  Eigen::AlignedBox3f extent;
  for (uint32_t i = part.first; i < part.first + part.count; ++i) {
    extent.extend(centers[i]);
  }
  int axis = 0;
  extent.sizes().maxCoeff(&axis);
  const float low = extent.min()[axis];
  const float size = extent.sizes()[axis];
  uint32_t middle = part.first + part.count / 2;
  if (size > 0.0F) {
    const auto bin_of = [&](uint32_t i) {
      const float share = (centers[i][axis] - low) / size;
      return std::min(kBins - 1, static_cast<int>(share * static_cast<float>(kBins)));
    };
    std::array<Eigen::AlignedBox3f, kBins> boxes;
    std::array<uint32_t, kBins> counts{};
    for (uint32_t i = part.first; i < part.first + part.count; ++i) {
      const auto bin = static_cast<std::size_t>(bin_of(i));
      ++counts[bin];
      for (const Vector3f& corner : faces_[i].corners) {
        boxes[bin].extend(corner);
      }
    }
    double best = std::numeric_limits<double>::infinity();
    int best_bin = 0;
    for (int border = 1; border < kBins; ++border) {
      std::array<Eigen::AlignedBox3f, 2> sides;
      std::array<uint32_t, 2> side_counts{};
      for (int bin = 0; bin < kBins; ++bin) {
        const auto i = static_cast<std::size_t>(bin);
        const std::size_t side = bin < border ? 0 : 1;
        sides[side].extend(boxes[i]);
        side_counts[side] += counts[i];
      }
      const double cost = area(sides[0]) * side_counts[0] + area(sides[1]) * side_counts[1];
      if (side_counts[0] > 0 && side_counts[1] > 0 && cost < best) {
        best = cost;
        best_bin = border;
      }
    }
    uint32_t next = part.first;
    for (uint32_t i = part.first; i < part.first + part.count; ++i) {
      if (bin_of(i) < best_bin) {
        std::swap(faces_[i], faces_[next]);
        std::swap(centers[i], centers[next]);
        ++next;
      }
    }
    middle = next;
  }
  return {part_of(part.first, middle - part.first),
          part_of(middle, part.first + part.count - middle)};
}

uint32_t RayScene::build(const Part& part, std::vector<Vector3f>& centers) {
  std::vector<Part> parts{part};
  while (parts.size() < 4) {
    const auto largest = std::ranges::max_element(
        parts, {}, [](const Part& p) { return p.count > kLeafFaces ? area(p.box) + 1e-30 : 0.0; });
    if (largest->count <= kLeafFaces) {
      break;
    }
    const auto halves = split(*largest, centers);
    *largest = halves[0];
    parts.push_back(halves[1]);
  }
  const auto index = static_cast<uint32_t>(nodes_.size());
  nodes_.emplace_back();
  for (std::size_t i = 0; i < 4; ++i) {
    const bool used = i < parts.size();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      nodes_[index].low[axis][i] = used ? parts[i].box.min()[a] - padding_ : kInfinity;
      nodes_[index].high[axis][i] = used ? parts[i].box.max()[a] + padding_ : -kInfinity;
    }
    nodes_[index].child[i] = 0;
    nodes_[index].faces[i] = 0;
    if (used && parts[i].count <= kLeafFaces) {
      nodes_[index].child[i] = parts[i].first;
      nodes_[index].faces[i] = parts[i].count;
    } else if (used) {
      const uint32_t child = build(parts[i], centers);
      nodes_[index].child[i] = child;
    }
  }
  return index;
}

std::optional<RayHit> RayScene::cast(const Vector3d& origin, const Vector3d& direction,
                                     double max_distance) const {
  if (nodes_.empty()) {
    return std::nullopt;
  }
  const Vector3f start = origin.cast<float>();
  Vector3f inverse;
  for (int axis = 0; axis < 3; ++axis) {
    const auto d = static_cast<float>(direction[axis]);
    inverse[axis] = 1.0F / (std::abs(d) > 1e-12F ? d : std::copysign(1e-12F, d));
  }
  double nearest = max_distance;
  const Face* hit = nullptr;
  struct Entry {
    float distance;
    uint32_t node;
  };
  std::array<Entry, kStackSize> stack;
  std::size_t depth = 0;
  stack[depth++] = {0.0F, 0};
  while (depth > 0) {
    const Entry entry = stack[--depth];
    const auto limit = static_cast<float>(nearest) * 1.00001F + padding_;
    if (entry.distance > limit) {
      continue;
    }
    const Node& node = nodes_[entry.node];
    std::array<float, 4> enter;
    std::array<float, 4> leave;
    for (std::size_t i = 0; i < 4; ++i) {
      enter[i] = 0.0F;
      leave[i] = limit;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      const std::array<float, 4>& near = inverse[a] >= 0.0F ? node.low[axis] : node.high[axis];
      const std::array<float, 4>& far = inverse[a] >= 0.0F ? node.high[axis] : node.low[axis];
      for (std::size_t i = 0; i < 4; ++i) {
        const float from = (near[i] - start[a]) * inverse[a];
        const float to = (far[i] - start[a]) * inverse[a] * 1.000001F;
        enter[i] = from > enter[i] ? from : enter[i];
        leave[i] = to < leave[i] ? to : leave[i];
      }
    }
    const std::size_t first = depth;
    for (std::size_t i = 0; i < 4; ++i) {
      if (!(enter[i] <= leave[i])) {
        continue;
      }
      if (node.faces[i] == 0) {
        // Nearer children come off the stack first.
        std::size_t at = depth++;
        for (; at > first && stack[at - 1].distance < enter[i]; --at) {
          stack[at] = stack[at - 1];
        }
        stack[at] = {enter[i], node.child[i]};
        continue;
      }
      for (uint32_t k = node.child[i]; k < node.child[i] + node.faces[i]; ++k) {
        const Face& face = faces_[k];
        const Vector3d a = face.corners[0].cast<double>();
        const auto t = distance_along(origin, direction, a, face.corners[1].cast<double>() - a,
                                      face.corners[2].cast<double>() - a);
        if (t && (*t < nearest || (*t == nearest && hit != nullptr && face.index < hit->index))) {
          nearest = *t;
          hit = &face;
        }
      }
    }
  }
  if (hit == nullptr) {
    return std::nullopt;
  }
  const Vector3d a = hit->corners[0].cast<double>();
  const Vector3d cross =
      (hit->corners[1].cast<double>() - a).cross(hit->corners[2].cast<double>() - a);
  const Vector3d normal = cross / std::sqrt(cross.squaredNorm());
  return RayHit{.distance = nearest,
                .normal = normal.dot(direction) > 0.0 ? Vector3d(-normal) : normal,
                .material = hit->material};
}

double RayScene::distance_to(const Vector3d& point) const {
  double best = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, uint32_t>> open{{0.0, 0}};
  while (!open.empty() && !nodes_.empty()) {
    const auto [bound, index] = open.back();
    open.pop_back();
    if (bound >= best) {
      continue;
    }
    const Node& node = nodes_[index];
    for (std::size_t i = 0; i < 4; ++i) {
      double squared = 0.0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at = point[static_cast<Eigen::Index>(axis)];
        const double off = std::max({0.0, static_cast<double>(node.low[axis][i]) - at,
                                     at - static_cast<double>(node.high[axis][i])});
        squared += off * off;
      }
      if (!(squared < best)) {
        continue;
      }
      if (node.faces[i] == 0) {
        open.emplace_back(squared, node.child[i]);
        continue;
      }
      for (uint32_t k = node.child[i]; k < node.child[i] + node.faces[i]; ++k) {
        best = std::min(best, squared_distance(point, faces_[k].corners));
      }
    }
  }
  return std::sqrt(best);
}

}  // namespace adit
