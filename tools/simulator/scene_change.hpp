// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A scene on another day: some of its movable objects are gone, elsewhere, or more than before.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/upright_box.hpp"
#include "adit/tools/simulator/scene.hpp"

namespace adit {

/// Which of a scene's movable objects change.
struct ChangeOptions {
  double share = 0.0;  ///< of them, 0 to 1; 0: none changes
  uint64_t seed = 1;   ///< another seed, other objects and other places
};

enum class ChangeKind { removed, added };
std::string_view to_string(ChangeKind kind);

/// What a change leaves where an object was, or puts where nothing was.
struct SceneChange {
  std::size_t object = 0;  ///< its number among the scene's movable objects
  std::string label{};
  ChangeKind kind = ChangeKind::removed;
  bool moved = false;  ///< removed here and added there: there are two changes of this object
  UprightBox box{};    ///< world
};

struct ChangedScene {
  Scene scene{};
  std::vector<SceneChange> changes{};
};

/// Changes that share of the movable objects, one at least: about a third each is removed, moved,
/// or joined by a copy. New places are free in the scene as it was, on the same kind of ground, and
/// aside of the route and of what moves. What is longer than wide slides along its length, as
/// parked cars do; everything else goes in any direction. An object without such a place is removed
/// instead of moved, and not copied. The same options give the same bytes on any machine.
ChangedScene changed_scene(Scene scene, const ChangeOptions& options);

/// The changes as JSON (docs/simulator.md). Throws OutputError.
void write_changes(const std::filesystem::path& file, const ChangeOptions& options,
                   std::size_t movable, const std::vector<SceneChange>& changes);

}  // namespace adit
