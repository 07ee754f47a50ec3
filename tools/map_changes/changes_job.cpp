// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_changes/changes_job.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adit/slam/core/median.hpp"
#include "adit/tools/map_changes/changes_report.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {
namespace {

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
  const ChangedSpace space = changed_space(maps, on_step);
  ChangesOutcome outcome{.sessions = maps.sessions,
                         .voxel = space.edge,
                         .points = space.points,
                         .georeferenced = maps.georeference.has_value()};
  for (const std::vector<std::size_t>& members : space.objects) {
    outcome.objects.push_back(object_of(space.voxels, members, maps));
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
