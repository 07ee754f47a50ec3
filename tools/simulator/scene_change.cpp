// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_change.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/tools/simulator/counter_random.hpp"
#include "adit/tools/simulator/repeatable_math.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kCell = 2.0;          // m, of the grid that finds triangles
constexpr double kGap = 0.05;          // m that is left around a new place
constexpr double kUneven = 0.15;       // m above its ground that anything may stick up there
constexpr double kRouteGap = 1.2;      // m to the route and to the paths of what moves
constexpr double kElongated = 1.5;     // length over width: it slides along its length
constexpr double kTurn = 5 * kDegree;  // at most; half a turn is drawn as well
constexpr double kStep = 0.5;          // m, that the ground may be higher or lower there
constexpr int kTries = 40;
constexpr double kMovingFor = 120.0;  // s of the moving objects' paths that are kept free
constexpr double kMovingStep = 0.5;   // s

Mesh mesh_of(const Mesh& mesh, const MeshPart& part) {
  Mesh copy;
  const auto vertex = mesh.vertices.begin() + static_cast<std::ptrdiff_t>(part.first_vertex);
  copy.vertices.assign(vertex, vertex + static_cast<std::ptrdiff_t>(part.vertices));
  const auto first = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(part.first_triangle);
  copy.triangles.assign(first, first + static_cast<std::ptrdiff_t>(part.triangles));
  for (Triangle& triangle : copy.triangles) {
    for (uint32_t& corner : triangle.corners) {
      corner -= static_cast<uint32_t>(part.first_vertex);
    }
  }
  return copy;
}

/// The mesh without these of its movable objects, which are in order.
Mesh without(const Mesh& mesh, const std::vector<std::size_t>& objects) {
  Mesh rest;
  const auto append = [&](std::size_t vertex, std::size_t vertex_end, std::size_t triangle,
                          std::size_t triangle_end, std::size_t vertices_left_out) {
    for (std::size_t i = vertex; i < vertex_end; ++i) {
      rest.vertices.push_back(mesh.vertices[i]);
    }
    for (std::size_t i = triangle; i < triangle_end; ++i) {
      Triangle moved = mesh.triangles[i];
      for (uint32_t& corner : moved.corners) {
        corner -= static_cast<uint32_t>(vertices_left_out);
      }
      rest.triangles.push_back(moved);
    }
  };
  std::size_t vertex = 0;
  std::size_t triangle = 0;
  std::size_t left_out = 0;
  for (const std::size_t object : objects) {
    const MeshPart& part = mesh.movable[object];
    append(vertex, part.first_vertex, triangle, part.first_triangle, left_out);
    vertex = part.first_vertex + part.vertices;
    triangle = part.first_triangle + part.triangles;
    left_out += part.vertices;
  }
  append(vertex, mesh.vertices.size(), triangle, mesh.triangles.size(), left_out);
  return rest;
}

void add(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (Triangle triangle : other.triangles) {
    for (uint32_t& corner : triangle.corners) {
      corner += first;
    }
    mesh.triangles.push_back(triangle);
  }
}

UprightBox box_of(const Mesh& mesh) {
  std::vector<Vector3d> points;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    points.emplace_back(vertex.cast<double>());
  }
  return upright_box(points);
}

double distance_to_segment(const Vector2d& at, const Vector2d& from, const Vector2d& to) {
  const Vector2d edge = to - from;
  const double u = std::clamp((at - from).dot(edge) / std::max(1e-9, edge.squaredNorm()), 0.0, 1.0);
  return std::sqrt((at - from - u * edge).squaredNorm());
}

/// What of a scene is taken, so that nothing is put there.
class FreeSpace {
 public:
  explicit FreeSpace(const Scene& scene) : mesh_(&scene.mesh), route_(scene.route) {
    for (std::size_t i = 0; i < mesh_->triangles.size(); ++i) {
      const Eigen::AlignedBox3f box = box_around(i);
      visit(box.min().cast<double>().head<2>(), box.max().cast<double>().head<2>(),
            [&](const Cell& cell) { cells_[cell].push_back(i); });
    }
    for (const MovingObject& object : scene.moving) {
      for (double time = 0.0; time < kMovingFor; time += kMovingStep) {
        moving_.emplace_back(object.T_world_object(time).translation().head<2>());
      }
    }
  }

  /// Nothing is in the box nor near it but the ground, whose height that is, and no path leads by.
  bool is_free(const UprightBox& box, double ground) const {
    const Eigen::AlignedBox2d around = box_around(box);
    const Eigen::AlignedBox3f space(
        Eigen::Vector3f(
            static_cast<float>(around.min().x() - kGap),
            static_cast<float>(around.min().y() - kGap),
            static_cast<float>(std::max(box.centre.z() - 0.5 * box.size.z(), ground) + kUneven)),
        Eigen::Vector3f(static_cast<float>(around.max().x() + kGap),
                        static_cast<float>(around.max().y() + kGap),
                        static_cast<float>(box.centre.z() + 0.5 * box.size.z() + kGap)));
    bool taken = std::ranges::any_of(
        put_, [&](const Eigen::AlignedBox3f& other) { return other.intersects(space); });
    visit(around.min(), around.max(), [&](const Cell& cell) {
      const auto found = cells_.find(cell);
      taken = taken || (found != cells_.end() &&
                        std::ranges::any_of(found->second, [&](std::size_t triangle) {
                          return box_around(triangle).intersects(space);
                        }));
    });
    return !taken && is_off_paths(around);
  }

  void put(const UprightBox& box) {
    const Eigen::AlignedBox2d around = box_around(box);
    const Vector3d half(0.0, 0.0, 0.5 * box.size.z());
    Eigen::AlignedBox3f taken;
    taken.extend(Eigen::Vector3f(
        (Vector3d(around.min().x(), around.min().y(), box.centre.z()) - half).cast<float>()));
    taken.extend(Eigen::Vector3f(
        (Vector3d(around.max().x(), around.max().y(), box.centre.z()) + half).cast<float>()));
    put_.push_back(taken);
  }

  /// m, of the highest surface that is not above `below`, that object's own apart; none: there is
  /// none.
  std::optional<double> ground(const Vector2d& at, double below, const MeshPart& object) const {
    std::optional<double> highest;
    visit(at, at, [&](const Cell& cell) {
      const auto found = cells_.find(cell);
      if (found == cells_.end()) {
        return;
      }
      for (const std::size_t triangle : found->second) {
        const bool is_own = triangle - object.first_triangle < object.triangles;
        const std::optional<double> z = is_own ? std::nullopt : height(triangle, at);
        if (z && *z <= below) {
          highest = std::max(highest.value_or(*z), *z);
        }
      }
    });
    return highest;
  }

 private:
  using Cell = std::pair<int64_t, int64_t>;

  template <class Visitor>
  static void visit(const Vector2d& low, const Vector2d& high, const Visitor& visitor) {
    const auto cell = [](double x) { return static_cast<int64_t>(std::floor(x / kCell)); };
    for (int64_t x = cell(low.x()); x <= cell(high.x()); ++x) {
      for (int64_t y = cell(low.y()); y <= cell(high.y()); ++y) {
        visitor(Cell(x, y));
      }
    }
  }

  Eigen::AlignedBox3f box_around(std::size_t triangle) const {
    Eigen::AlignedBox3f box;
    for (const uint32_t corner : mesh_->triangles[triangle].corners) {
      box.extend(mesh_->vertices[corner]);
    }
    return box;
  }

  static Eigen::AlignedBox2d box_around(const UprightBox& box) {
    Eigen::AlignedBox2d around;
    for (const Vector2d& corner : box.footprint()) {
      around.extend(corner);
    }
    return around;
  }

  std::optional<double> height(std::size_t triangle, const Vector2d& at) const {
    const auto& corners = mesh_->triangles[triangle].corners;
    const Vector3d a = mesh_->vertices[corners[0]].cast<double>();
    const Vector3d b = mesh_->vertices[corners[1]].cast<double>() - a;
    const Vector3d c = mesh_->vertices[corners[2]].cast<double>() - a;
    const double area = b.x() * c.y() - b.y() * c.x();
    if (area == 0.0) {
      return {};
    }
    const Vector2d p = at - a.head<2>();
    const double u = (p.x() * c.y() - p.y() * c.x()) / area;
    const double v = (b.x() * p.y() - b.y() * p.x()) / area;
    if (u < 0.0 || v < 0.0 || u + v > 1.0) {
      return {};
    }
    return a.z() + u * b.z() + v * c.z();
  }

  bool is_off_paths(const Eigen::AlignedBox2d& around) const {
    const double reach = kRouteGap + 0.5 * around.diagonal().norm();
    for (std::size_t i = 0; i < route_.size(); ++i) {
      const Vector2d from = route_[i].head<2>();
      const Vector2d to = route_[(i + 1) % route_.size()].head<2>();
      if (distance_to_segment(around.center(), from, to) > reach) {
        continue;
      }
      // Along the segment, closely enough for the gap.
      const int steps = 1 + static_cast<int>(4.0 * std::sqrt((to - from).squaredNorm()));
      for (int k = 0; k <= steps; ++k) {
        const Vector2d at = from + (to - from) * (static_cast<double>(k) / steps);
        if (around.squaredExteriorDistance(at) < kRouteGap * kRouteGap) {
          return false;
        }
      }
    }
    return std::ranges::none_of(moving_, [&](const Vector2d& at) {
      return around.squaredExteriorDistance(at) < kRouteGap * kRouteGap;
    });
  }

  const Mesh* mesh_;
  std::vector<Vector3d> route_;
  std::vector<Vector2d> moving_{};
  std::map<Cell, std::vector<std::size_t>> cells_{};
  std::vector<Eigen::AlignedBox3f> put_{};  ///< what was put there since
};

/// An object at a new place.
struct Placed {
  Mesh mesh{};
  UprightBox box{};
};

/// Numbers for one object: the first decides what happens to it, the others where it goes.
class Draws {
 public:
  Draws(const CounterRandom& random, std::size_t object)
      : random_(&random), next_((object + 1) << 32U) {}
  double uniform(double low, double high) { return low + (high - low) * random_->uniform(next_++); }

 private:
  const CounterRandom* random_;
  uint64_t next_;
};

std::optional<Placed> placed_elsewhere(const Mesh& object, const MeshPart& part,
                                       const FreeSpace& space, Draws& draws) {
  const UprightBox box = box_of(object);
  const std::optional<double> ground = space.ground(box.centre.head<2>(), box.centre.z(), part);
  const bool slides = box.size.x() > kElongated * box.size.y();
  const double length = slides ? box.size.x() : std::sqrt(box.size.head<2>().squaredNorm());
  for (int i = 0; ground && i < kTries; ++i) {
    const double way = length * draws.uniform(1.1, 4.0);
    const double angle = draws.uniform(0.0, 2.0 * kPi);
    const double turn = draws.uniform(-kTurn, kTurn) + (angle < kPi ? 0.0 : kPi);
    const SinCos direction = repeatable_sin_cos(angle);
    const Vector2d off = slides ? Vector2d((angle < kPi ? way : -way) * box.along)
                                : Vector2d(way * direction.cos, way * direction.sin);
    const Vector2d at = box.centre.head<2>() + off;
    const std::optional<double> there = space.ground(at, *ground + kStep, part);
    if (!there || *there < *ground - kStep) {
      continue;
    }
    Placed placed{.mesh = object};
    const Eigen::Matrix3d rotation = rotation_from_yaw_pitch_roll(turn, 0.0, 0.0);
    for (Eigen::Vector3f& vertex : placed.mesh.vertices) {
      const Vector3d p = rotation * (vertex.cast<double>() - box.centre) + box.centre;
      vertex = (p + Vector3d(off.x(), off.y(), *there - *ground)).cast<float>();
    }
    placed.box = box_of(placed.mesh);
    if (space.is_free(placed.box, *there)) {
      return placed;
    }
  }
  return {};
}

/// That share of so many objects, one at least, in order.
std::vector<std::size_t> chosen(std::size_t objects, double share, const CounterRandom& random) {
  std::vector<std::pair<uint64_t, std::size_t>> drawn;
  for (std::size_t i = 0; i < objects; ++i) {
    drawn.emplace_back(random.bits(i), i);
  }
  std::ranges::sort(drawn);
  const double count = std::max(1.0, std::floor(share * static_cast<double>(objects) + 0.5));
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < std::min(objects, static_cast<std::size_t>(count)); ++i) {
    numbers.push_back(drawn[i].second);
  }
  std::ranges::sort(numbers);
  return numbers;
}

}  // namespace

std::string_view to_string(ChangeKind kind) {
  return kind == ChangeKind::removed ? "removed" : "added";
}

ChangedScene changed_scene(Scene scene, const ChangeOptions& options) {
  const CounterRandom random(options.seed, RandomStream::change);
  FreeSpace space(scene);
  ChangedScene changed;
  std::vector<std::size_t> gone;
  std::vector<Mesh> put;
  for (const std::size_t i : chosen(scene.mesh.movable.size(), options.share, random)) {
    Draws draws(random, i);
    const double kind = draws.uniform(0.0, 3.0);
    const bool is_removed = kind < 2.0;
    const MeshPart& part = scene.mesh.movable[i];
    const Mesh object = mesh_of(scene.mesh, part);
    const std::optional<Placed> placed =
        kind < 1.0 ? std::nullopt : placed_elsewhere(object, part, space, draws);
    const bool is_moved = is_removed && placed.has_value();
    if (is_removed) {
      gone.push_back(i);
      changed.changes.push_back({.object = i,
                                 .label = part.label,
                                 .kind = ChangeKind::removed,
                                 .moved = is_moved,
                                 .box = box_of(object)});
    }
    if (placed) {
      space.put(placed->box);
      put.push_back(placed->mesh);
      changed.changes.push_back({.object = i,
                                 .label = part.label,
                                 .kind = ChangeKind::added,
                                 .moved = is_moved,
                                 .box = placed->box});
    }
  }
  Mesh mesh = without(scene.mesh, gone);
  for (const Mesh& object : put) {
    add(mesh, object);
  }
  changed.scene = std::move(scene);
  changed.scene.mesh = std::move(mesh);
  return changed;
}

void write_changes(const std::filesystem::path& file, const ChangeOptions& options,
                   std::size_t movable, const std::vector<SceneChange>& changes) {
  const auto numbers = [](const Vector3d& v) { return std::vector{v.x(), v.y(), v.z()}; };
  nlohmann::ordered_json json = {{"change", options.share},
                                 {"change_seed", options.seed},
                                 {"movable", movable},
                                 {"changes", nlohmann::ordered_json::array()}};
  for (const SceneChange& change : changes) {
    const double yaw = repeatable_atan2(change.box.along.y(), change.box.along.x());
    json["changes"].push_back({{"object", change.object},
                               {"label", change.label},
                               {"what", to_string(change.kind)},
                               {"moved", change.moved},
                               {"centre_m", numbers(change.box.centre)},
                               {"size_m", numbers(change.box.size)},
                               {"yaw_deg", yaw * kDegreesPerRadian},
                               {"volume_m3", change.box.volume()}});
  }
  write_text_file(file, json.dump(2) + "\n");
}

}  // namespace adit
