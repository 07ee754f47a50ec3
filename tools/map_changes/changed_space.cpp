// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_changes/changed_space.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <list>
#include <utility>

#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/map_tiles.hpp"

namespace adit {
namespace {

constexpr std::size_t kLeastPoints = 8;  // of an object
constexpr double kFinest = 0.2;          // m, a voxel's edge
constexpr int64_t kVoxelsAcross = 256;

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

}  // namespace

ChangedSpace changed_space(const ComparedMaps& maps,
                           const std::function<bool(const ChangesStep&)>& on_step) {
  Comparison comparison(maps, kSubmapBytes);
  ChangedSpace space{.edge = comparison.edge()};
  const auto tiles = comparison.tiles();
  std::size_t done = 0;
  for (const auto& [part_tile, keyframes] : tiles) {
    ChangesOfTile found = comparison.changes(part_tile.second, keyframes);
    space.points += found.points;
    std::ranges::move(found.voxels, std::back_inserter(space.voxels));
    if (!on_step({.done = ++done, .total = tiles.size()})) {
      throw MergeStopped("the comparison was stopped");
    }
  }
  space.objects = changed_objects(space.voxels, kLeastPoints);
  return space;
}

GoneSpace::GoneSpace(const ComparedMaps& maps, const ChangedSpace& space,
                     std::optional<Nanoseconds> until)
    : edge_(space.edge) {
  std::map<uint32_t, Nanoseconds> begins;  // of periods
  for (const ComparedSession& session : maps.sessions) {
    periods_[session.id] = session.period;
    begins[session.period] = session.first;
  }
  for (const std::vector<std::size_t>& members : space.objects) {
    for (const std::size_t member : members) {
      const ChangedVoxel& voxel = space.voxels[member];
      if (voxel.change == ChangeOfSpace::gone && (!until || begins.at(voxel.other) <= *until)) {
        const Index index{voxel.voxel.x(), voxel.voxel.y(), voxel.voxel.z()};
        last_[index] = std::max(last_[index], voxel.session);
      }
    }
  }
}

bool GoneSpace::has(const Eigen::Vector3d& point, SessionId session) const {
  const auto along = [&](Eigen::Index axis) {
    return static_cast<int64_t>(std::floor(point[axis] / edge_));
  };
  const auto found = last_.find({along(0), along(1), along(2)});
  const auto period = periods_.find(session);
  return found != last_.end() && period != periods_.end() && period->second <= found->second;
}

GoneSpace gone_space(const std::filesystem::path& map, std::optional<Nanoseconds> until,
                     const std::function<bool(const ChangesStep&)>& on_step) {
  const ComparedMaps maps = compared_maps({map}, {}, [](const MergeStep&) { return true; });
  return {maps, changed_space(maps, on_step), until};
}

}  // namespace adit
