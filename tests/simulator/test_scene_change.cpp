// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/scene_change.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

Vector3d vertex(const Mesh& mesh, std::size_t i) {
  return mesh.vertices[i].cast<double>();
}

/// Vertices of the mesh inside the box, which is made smaller by a centimetre.
std::size_t vertices_in(const Mesh& mesh, const UprightBox& box) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    count += box.contains(vertex(mesh, i), 0.01) ? 1U : 0U;
  }
  return count;
}

TEST(SceneChange, ThatShareOfTheObjectsIsGoneElsewhereOrMore) {
  for (const char* name : {"room", "office", "mine"}) {
    const Scene scene = make_scene(name, 3);
    const std::size_t movable = scene.mesh.movable.size();
    ASSERT_GT(movable, 10U) << name;
    const ChangedScene changed = changed_scene(scene, {.share = 0.3, .seed = 4});
    std::vector<std::size_t> objects;
    for (const SceneChange& change : changed.changes) {
      objects.push_back(change.object);
      EXPECT_EQ(change.label, scene.mesh.movable[change.object].label);
      EXPECT_GT(change.box.volume(), 0.0);
      const Mesh& with = change.kind == ChangeKind::removed ? scene.mesh : changed.scene.mesh;
      const Mesh& less = change.kind == ChangeKind::removed ? changed.scene.mesh : scene.mesh;
      EXPECT_GE(vertices_in(with, change.box),
                vertices_in(less, change.box) + scene.mesh.movable[change.object].vertices)
          << name << ", object " << change.object;
    }
    EXPECT_TRUE(std::ranges::is_sorted(objects));
    objects.erase(std::ranges::unique(objects).begin(), objects.end());
    const double wanted = 0.3 * static_cast<double>(movable);
    EXPECT_LE(static_cast<double>(objects.size()), wanted + 0.5) << name;
    EXPECT_GE(static_cast<double>(objects.size()), 0.5 * wanted) << name << ": few had no place";
  }
}

TEST(SceneChange, ASceneStaysAsItIsApartFromItsChanges) {
  const Scene scene = make_scene("office", 3);
  const ChangedScene once = changed_scene(scene, {.share = 0.2, .seed = 4});
  const ChangedScene again = changed_scene(scene, {.share = 0.2, .seed = 4});
  EXPECT_EQ(once.scene.mesh.vertices, again.scene.mesh.vertices);
  EXPECT_NE(once.scene.mesh.vertices,
            changed_scene(scene, {.share = 0.2, .seed = 5}).scene.mesh.vertices);
  std::size_t vertices = scene.mesh.vertices.size();
  std::size_t triangles = scene.mesh.triangles.size();
  for (const SceneChange& change : once.changes) {
    const MeshPart& part = scene.mesh.movable[change.object];
    vertices += change.kind == ChangeKind::added ? part.vertices : -part.vertices;
    triangles += change.kind == ChangeKind::added ? part.triangles : -part.triangles;
  }
  EXPECT_EQ(once.scene.mesh.vertices.size(), vertices);
  EXPECT_EQ(once.scene.mesh.triangles.size(), triangles);
  for (const Triangle& triangle : once.scene.mesh.triangles) {
    EXPECT_LT(std::ranges::max(triangle.corners), vertices);
  }
}

TEST(SceneChange, AMovedObjectKeepsItsSizeAndIsAsideOfTheRoute) {
  const Scene scene = make_scene("city", 3);
  const ChangedScene changed = changed_scene(scene, {.share = 0.05, .seed = 4});
  std::size_t moved = 0;
  for (std::size_t i = 0; i + 1 < changed.changes.size(); ++i) {
    const SceneChange& from = changed.changes[i];
    const SceneChange& to = changed.changes[i + 1];
    if (!from.moved || from.kind != ChangeKind::removed) {
      continue;
    }
    ++moved;
    EXPECT_EQ(from.object, to.object);
    EXPECT_TRUE(to.moved && to.kind == ChangeKind::added);
    EXPECT_TRUE(from.box.size.isApprox(to.box.size, 0.02));
    EXPECT_GT((from.box.centre - to.box.centre).norm(), 1.0);
  }
  EXPECT_GT(moved, 10U);
}

class ChangedRecording : public testing::Test {
 protected:
  SimulationOptions options(const std::string& name, double share) const {
    SimulationOptions options;
    options.scene = "room";
    options.duration = 0.2;
    options.picture = false;
    options.change = {.share = share, .seed = 2};
    options.output = folder_.path() / (name + ".mcap");
    return options;
  }
  test::TemporaryFolder folder_;
};

TEST_F(ChangedRecording, TheTruthIsBesideIt) {
  const SimulationOptions simulation = options("later", 0.4);
  EXPECT_GT(simulate(simulation, {}).changes, 0U);
  const auto truth =
      nlohmann::json::parse(read_text_file(SimulationFiles(simulation.output).changes));
  EXPECT_EQ(truth.at("change_seed"), 2);
  ASSERT_FALSE(truth.at("changes").empty());
  for (const auto& change : truth.at("changes")) {
    const auto& size = change.at("size_m");
    const double volume = size[0].get<double>() * size[1].get<double>() * size[2].get<double>();
    EXPECT_NEAR(change.at("volume_m3").get<double>(), volume, 1e-9);
    EXPECT_TRUE(change.at("what") == "removed" || change.at("what") == "added");
  }
}

TEST_F(ChangedRecording, NothingIsWrittenWithoutAShareAndNonsenseIsRefused) {
  const SimulationOptions simulation = options("same", 0.0);
  EXPECT_EQ(simulate(simulation, {}).changes, 0U);
  EXPECT_FALSE(std::filesystem::exists(SimulationFiles(simulation.output).changes));
  for (const double share : {-0.1, 1.1, std::nan("")}) {
    EXPECT_THROW(simulate(options("no", share), {}), UsageError) << share;
  }
  SimulationOptions field = options("field", 0.2);
  field.scene = "field";
  EXPECT_THROW(simulate(field, {}), UsageError);
}

}  // namespace
}  // namespace adit
