// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene.hpp"

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

struct Entry {
  std::string_view name;
  Scene (*make)(uint64_t seed);
};
constexpr std::array kEntries{Entry{"city", make_city},
                              Entry{"equal_houses", make_equal_houses},
                              Entry{"field", make_field},
                              Entry{"forest", make_forest},
                              Entry{"mine", make_mine},
                              Entry{"office", make_office},
                              Entry{"repeated_wing", make_repeated_wing},
                              Entry{"ring_tunnel", make_ring_tunnel},
                              Entry{"room", make_room},
                              Entry{"wings", make_wings}};

constexpr double kStep = 0.05;  // s

/// `way`: the carrier's positions, a step apart.
bool comes_within(const MovingObject& object, double clearance,
                  const std::vector<Eigen::Vector3d>& way, const Checkpoint& checkpoint) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3f& vertex : object.mesh.vertices) {
    box.extend(vertex.head<2>().cast<double>());
  }
  for (std::size_t i = 0; i < way.size(); ++i) {
    pass(checkpoint);
    const Eigen::Vector3d carrier =
        object.T_world_object(kStep * static_cast<double>(i)).inverse() * way[i];
    if (box.squaredExteriorDistance(Eigen::Vector2d(carrier.head<2>())) < clearance * clearance) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kEntries) {
    names.emplace_back(entry.name);
  }
  return names;
}

void require_scene(std::string_view name) {
  if (std::ranges::find(kEntries, name, &Entry::name) == kEntries.end()) {
    throw UsageError("there is no scene '" + std::string(name) + "'. " +
                     suggestion(std::string(name), scene_names()) + ".");
  }
}

Scene make_scene(std::string_view name, uint64_t seed) {
  require_scene(name);
  Scene scene = std::ranges::find(kEntries, name, &Entry::name)->make(seed);
  scene.name = name;
  return scene;
}

Scene out_of_the_way(Scene scene, const std::function<Eigen::Isometry3d(double)>& T_world_body,
                     double duration, double clearance, const Checkpoint& checkpoint) {
  std::vector<Eigen::Vector3d> way;
  for (double time = 0.0; !scene.moving.empty() && time <= duration; time += kStep) {
    way.emplace_back(T_world_body(time).translation());
  }
  std::erase_if(scene.moving, [&](const MovingObject& object) {
    return comes_within(object, clearance, way, checkpoint);
  });
  return scene;
}

}  // namespace adit
