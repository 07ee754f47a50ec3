// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_changes/changes_job.hpp"

#include <algorithm>
#include <cmath>
#include <list>
#include <map>
#include <tuple>
#include <utility>

#include "adit/slam/core/median.hpp"
#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/map_changes/changes_report.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/map_tiles.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {
namespace {

constexpr double kFinest = 0.2;  // m, a voxel's edge
constexpr int64_t kVoxelsAcross = 256;
constexpr std::size_t kLeastPoints = 8;  // of an object

class Comparison {
 public:
  Comparison(const ComparedMaps& maps, uint64_t submap_bytes)
      : maps_(&maps), edge_(std::max(kFinest, maps.r_submap)) {
    for (const auto& map : maps.maps) {
      caches_.emplace_back(submap_loader(*map), submap_bytes / maps.maps.size());
    }
  }

  double edge() const { return edge_; }

  /// Keyframes that look into each tile, one part of the map after another.
  using PartTile = std::pair<std::size_t, TileNumber>;
  std::map<PartTile, std::vector<std::size_t>> tiles() const {
    std::map<PartTile, std::vector<std::size_t>> tiles;
    for (std::size_t i = 0; i < maps_->keyframes.size(); ++i) {
      const ComparedKeyframe& keyframe = maps_->keyframes[i];
      const Eigen::AlignedBox2d plane(keyframe.seen.min().head<2>(), keyframe.seen.max().head<2>());
      visit_tiles({.cell = edge_, .across = kVoxelsAcross}, plane, [&](const TileNumber& tile) {
        tiles[{keyframe.part, tile}].push_back(i);
      });
    }
    return tiles;
  }

  ChangesOfTile changes(const TileNumber& tile, const std::vector<std::size_t>& keyframes) {
    const SpaceTile space{.centre = {tile.x * kVoxelsAcross + kVoxelsAcross / 2,
                                     tile.y * kVoxelsAcross + kVoxelsAcross / 2, 0},
                          .across = kVoxelsAcross};
    return changes_in_tile(
        space, edge_, keyframes.size(),
        [&](std::size_t i) {
          const ComparedKeyframe& keyframe = maps_->keyframes[keyframes[i]];
          SubmapCache& cache =
              *std::next(caches_.begin(), static_cast<std::ptrdiff_t>(keyframe.map));
          return SessionSubmap{.placed = {.T_map_keyframe = keyframe.T_common_keyframe,
                                          .submap = load_submap(cache, keyframe.id,
                                                                maps_->maps[keyframe.map]->file())},
                               .session = keyframe.period};
        },
        kLeastLogOdds);
  }

 private:
  const ComparedMaps* maps_;
  double edge_;
  std::list<SubmapCache> caches_{};
};

ChangedObject object_of(const std::vector<ChangedVoxel>& voxels,
                        const std::vector<std::size_t>& members, const ComparedMaps& maps) {
  ChangedObject object{.change = voxels[members.front()].change,
                       .period = voxels[members.front()].session,
                       .other = voxels[members.front()].other,
                       .voxels = members.size()};
  const bool is_gone = object.change == ChangeOfSpace::gone;
  std::vector<Eigen::Vector3d> points;
  std::vector<double> through;
  for (const std::size_t member : members) {
    const ChangedVoxel& voxel = voxels[member];
    points.insert(points.end(), voxel.points.begin(), voxel.points.end());
    through.push_back(voxel.through);
    const auto latest = std::max(object.period, voxel.session);
    const auto earliest = std::min(object.period, voxel.session);
    object.period = is_gone ? latest : earliest;
    object.other =
        is_gone ? std::min(object.other, voxel.other) : std::max(object.other, voxel.other);
  }
  object.points = points.size();
  object.through = static_cast<uint32_t>(median(through));
  const Eigen::Isometry3d T_map_common = maps.T_map_common(points.front());
  for (Eigen::Vector3d& point : points) {
    point = T_map_common * point;
  }
  object.box = upright_box(points);
  return object;
}

void place_on_earth(ChangedObject& object, const ProductCoordinates& earth) {
  object.place = earth.place(object.box.centre).geodetic;
  const double bottom = object.box.centre.z() - 0.5 * object.box.size.z();
  for (const Eigen::Vector2d& corner : object.box.footprint()) {
    object.footprint.push_back(earth.place({corner.x(), corner.y(), bottom}).geodetic);
  }
}

}  // namespace

ChangesOutcome changes_job(const ChangesCommandOptions& options,
                           const std::function<bool(const ChangesStep&)>& on_step) {
  std::size_t searched = 0;
  const ComparedMaps maps = compared_maps(options.maps, options.device, [&](const MergeStep&) {
    return on_step({.done = ++searched, .total = 0});
  });
  Comparison comparison(maps, kSubmapBytes);
  ChangesOutcome outcome{.sessions = maps.sessions,
                         .voxel = comparison.edge(),
                         .georeferenced = maps.georeference.has_value()};
  std::vector<ChangedVoxel> voxels;
  const auto tiles = comparison.tiles();
  std::size_t done = 0;
  for (const auto& [part_tile, keyframes] : tiles) {
    ChangesOfTile found = comparison.changes(part_tile.second, keyframes);
    outcome.points += found.points;
    std::ranges::move(found.voxels, std::back_inserter(voxels));
    if (!on_step({.done = ++done, .total = tiles.size()})) {
      throw MergeStopped("the comparison was stopped");
    }
  }
  for (const std::vector<std::size_t>& members : changed_objects(voxels, kLeastPoints)) {
    outcome.objects.push_back(object_of(voxels, members, maps));
  }
  if (maps.georeference) {
    const ProductCoordinates earth(*maps.georeference, ProductFrame::local);
    for (ChangedObject& object : outcome.objects) {
      place_on_earth(object, earth);
    }
  }
  std::ranges::stable_sort(outcome.objects, std::ranges::greater{},
                           [](const ChangedObject& object) { return object.box.volume(); });
  if (!options.output.empty()) {
    write_changes_geojson(options.output, outcome);
  }
  return outcome;
}

}  // namespace adit
