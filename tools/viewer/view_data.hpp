// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit view` shows: a map, a run's folder or a cloud, read once and made into tiles.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "adit/tools/map_edits/loop_addition.hpp"
#include "adit/tools/map_edits/loop_change.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/viewer/cloud_tiles.hpp"
#include "adit/tools/viewer/foxglove_feed.hpp"
#include "adit/tools/viewer/view_graph.hpp"

namespace adit {

struct ViewDataOptions {
  std::filesystem::path what;  ///< a map, a run's folder, or a cloud: PLY, PCD or LAS
  bool edit = false;           ///< loops may be revoked and restored
  VerifyLoop verify{};         ///< of loops that are proposed; empty: none can be
  /// Lays the truth over the map, also after an edit; empty: it is not known. What it throws is
  /// thrown.
  std::function<ViewTruth(const MapDatabase&)> truth{};
  /// Gives the points of a keyframe their colours; empty: a map's points have none.
  std::function<std::span<const CloudPoint>(std::span<const CloudPoint>)> paint{};
  std::function<bool()> stop{};  ///< asked while it is read: true ends that; empty: nothing does
};

/// The reading was ended by ViewDataOptions::stop.
class ViewStopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A map, a cloud or the folder of a run, by its name and what it holds; or nothing at all.
bool is_shown_as_it_is(const std::filesystem::path& what);

class ViewData {
 public:
  /// Reads it and makes its tiles; progress goes to `progress`. Throws InputError (nothing that can
  /// be shown, or damaged), OutputError (no room for temporary files), UsageError (`edit` or
  /// `truth` without a map), ViewStopped.
  ViewData(const ViewDataOptions& options, std::ostream& progress);

  uint64_t points() const { return tiles_.points(); }
  std::size_t keyframes() const { return keyframes_; }
  const std::string& title() const { return title_; }
  bool editable() const { return edit_; }

  /// JSON. The scene is what never changes: tiles, sweeps, times.
  const std::string& scene() const { return scene_; }
  const std::string& graph() const { return graph_; }

  /// As tile_message() has it; empty where there is no such tile. Throws OutputError.
  std::string tile(uint32_t number) const;

  /// The same for Foxglove's protocol, read when it is asked for first, and anew after a change.
  /// Throws InputError, OutputError.
  std::shared_ptr<FoxgloveFeed> foxglove();

  /// The answer to the question of where a place of the map's frame is (view_world.hpp).
  std::string place(const Eigen::Vector3d& p_map) const;

  /// Changes the map, and graph() with it. Throws what change_loop() does, UsageError where the
  /// view may not edit.
  LoopChange change(int64_t loop, LoopAction action);
  /// Lets a loop in. Throws what add_loop() does, UsageError where the view may not edit.
  LoopChange add(const LoopByHand& loop);

 private:
  void stop_if_wanted() const;
  void must_edit() const;
  LoopChange shown(LoopChange changed);
  std::string graph_text(const MapDatabase& map) const;
  void read_map(const std::filesystem::path& file, const ViewDataOptions& options,
                std::ostream& progress);
  void read_cloud(const std::filesystem::path& file, std::ostream& progress);
  void make_tiles(CloudTilesMaker& maker, std::ostream& progress);
  void make_scene(bool has_intensity, const std::vector<MapKeyframe>& tiled,
                  std::ostream& progress);

  std::string title_;
  std::filesystem::path folder_;  ///< of a run; empty: what is shown is a file
  std::filesystem::path map_;
  std::optional<Georeference> earth_;
  bool edit_ = false;
  VerifyLoop verify_;
  std::function<ViewTruth(const MapDatabase&)> truth_;
  std::function<bool()> stop_;
  std::size_t keyframes_ = 0;
  ViewSpan span_;
  std::vector<ViewSweep> sweeps_;
  CloudTiles tiles_;
  std::string scene_;
  std::string graph_;
  std::shared_ptr<FoxgloveFeed> foxglove_;
};

}  // namespace adit
