// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/volume_job.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "adit/slam/core/text.hpp"
#include "adit/tools/export/volume_input.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/plans/height_raster.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr double kVolumeCell = 0.25;   // m, in which ground is followed
constexpr double kSurroundings = 2.0;  // m around a polygon: enough cells for a plane, near enough
// m, one standard deviation: data sheets of range sensors state a systematic error of up to 3 cm.
constexpr double kRangeBias = 0.03;
// m, of the mean height of what has changed: maps bend against each other, and stable ground shows
// it elsewhere only. Root mean square of five simulated heaps (docs/volumes.md); the worst was 5.5
// mm.
constexpr double kLocalError = 0.0025;
constexpr double kGate = 3.0;  // standard deviations
// m2, of a change that nobody has pointed at: smaller ones are objects, which `adit changes` lists.
constexpr double kLeastChange = 1.0;

GroundLevels ground_levels(const std::vector<VolumeKeyframe>& keyframes) {
  GroundSearch search(kVolumeCell);
  std::vector<FloorStep> steps;
  for (const VolumeKeyframe& one : keyframes) {
    const std::vector<PlanPoint> points =
        plan_points_of(one.keyframe, load_submap(*one.map, one.keyframe.id, one.map->file()),
                       *one.coordinates, {});
    const Eigen::Vector3d sensor =
        one.coordinates->from_map(Eigen::Vector3d(one.keyframe.T_map_keyframe.translation()));
    steps.push_back(floor_step(one.keyframe, sensor, points));
    search.add(points);
  }
  return search.levels_from(floors_under(std::move(steps)));
}

/// Lengths in the product's plane over those on the ground, at the first keyframe.
double plane_scale(const VolumeKeyframe& at) {
  constexpr double kBaseline = 100.0;  // m
  const Eigen::Vector3d here = at.keyframe.T_map_keyframe.translation();
  const Eigen::Vector3d there = here + Eigen::Vector3d(kBaseline, 0.0, 0.0);
  const Eigen::Vector3d between = at.coordinates->from_map(there) - at.coordinates->from_map(here);
  // A map whose z axis is not up has a part of it in height.
  const double level = std::sqrt(std::max(0.0, kBaseline * kBaseline - between.z() * between.z()));
  return level > 0.0 ? between.head<2>().norm() / level : 1.0;
}

double area_of(const std::vector<Eigen::Vector2d>& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - polygon[0];
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - polygon[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

double distance_to(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& place) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d side = polygon[(i + 1) % polygon.size()] - polygon[i];
    const double length = std::max(side.squaredNorm(), 1e-12);
    const double share = std::clamp((place - polygon[i]).dot(side) / length, 0.0, 1.0);
    nearest = std::min(nearest, (place - polygon[i] - share * side).norm());
  }
  return nearest;
}

/// The cells for which `is_kept` holds.
GroundHeights kept(const GroundHeights& ground,
                   const std::function<bool(const GroundHeights::Index&)>& is_kept) {
  GroundHeights rest(ground.size());
  for (const auto& [cell, height] : ground.cells()) {
    if (is_kept(cell)) {
      rest.set(cell, height);
    }
  }
  return rest;
}

struct VolumeDifference {
  GroundHeights heights;  ///< m
  double offset_error = 0.0;
};

/// Of two grounds; sets what is known of stable ground and the offset.
VolumeDifference compare_grounds(const VolumeCommandOptions& options, const GroundPair& pair,
                                 const std::vector<Eigen::Vector2d>& polygon,
                                 VolumeOutcome& outcome) {
  VolumeDifference difference{.heights = difference_of(pair.after.heights, pair.before.heights)};
  // What changes lies within the polygon, says whoever draws it.
  bool is_known_to_be_stable = false;
  if (!polygon.empty()) {
    outcome.stable = stable_ground(kept(difference.heights, [&](const GroundHeights::Index& cell) {
      return !is_within(polygon, difference.heights.middle(cell));
    }));
    is_known_to_be_stable = outcome.stable.has_value();
  }
  if (!outcome.stable) {
    outcome.stable = stable_ground(difference.heights);
  }
  const double expected = std::hypot(outcome.tie_error.value_or(0.0), kRangeBias);
  if (!outcome.stable || options.as_measured) {
    difference.offset_error = expected;
    return difference;
  }
  outcome.offset_refused =
      !is_known_to_be_stable && std::abs(outcome.stable->offset) > kGate * expected;
  outcome.offset = outcome.offset_refused ? 0.0 : outcome.stable->offset;
  difference.offset_error =
      outcome.offset_refused
          ? expected
          : std::hypot(outcome.stable->error_of_mean(outcome.stable->area), kLocalError);
  return difference;
}

/// Heights above a plane; sets the plane, and what is known of the ground around the polygon.
VolumeDifference above_plane(const VolumeCommandOptions& options, const ClosedGround& ground,
                             const std::vector<Eigen::Vector2d>& polygon, VolumeOutcome& outcome) {
  VolumeDifference difference{.heights = GroundHeights(ground.heights.size())};
  GroundHeights around(ground.heights.size());
  if (outcome.base == VolumeBase::height) {
    outcome.plane = GroundPlane{.height = parse_double(options.above).value()};
    difference.offset_error = kRangeBias;
  } else {
    around = kept(ground.heights, [&](const GroundHeights::Index& cell) {
      const Eigen::Vector2d middle = ground.heights.middle(cell);
      return !is_within(polygon, middle) && distance_to(polygon, middle) <= kSurroundings;
    });
    outcome.plane = plane_through(around);
    if (!outcome.plane) {
      throw UsageError(
          "--above surroundings: too little ground was seen within 2 m around the polygon. Give "
          "its height: --above HEIGHT.");
    }
  }
  const auto above = [&](const GroundHeights& heights) {
    GroundHeights rest(heights.size());
    for (const auto& [cell, height] : heights.cells()) {
      rest.set(cell, height - outcome.plane->at(heights.middle(cell)));
    }
    return rest;
  };
  difference.heights = above(ground.heights);
  if (outcome.base == VolumeBase::surroundings) {
    outcome.stable = stable_ground(above(around));
    // The ground below the heap is as far from the plane as that around it, and nobody sees it.
    difference.offset_error = outcome.stable ? outcome.stable->spread : kRangeBias;
  }
  return difference;
}

void write_raster(const fs::path& file, const GroundPair& pair, const VolumeDifference& difference,
                  const VolumeInput& input) {
  GroundHeights less_offset(difference.heights.size());
  const std::vector<Eigen::Vector2d>& polygon = input.selection.polygon;
  const auto is_wanted = [&](const GroundHeights::Index& cell) {
    return polygon.empty() || is_within(polygon, less_offset.middle(cell));
  };
  for (const auto& [cell, height] : difference.heights.cells()) {
    if (is_wanted(cell)) {
      less_offset.set(cell, height - input.outcome.offset);
    }
  }
  const GroundHeights before = kept(pair.before.heights, is_wanted);
  const GroundHeights after = kept(pair.after.heights, is_wanted);
  std::vector<HeightBand> bands = {{.band = {"difference", "m"}, .values = &less_offset},
                                   {.band = {"after", "m"}, .values = &after}};
  if (!before.cells().empty()) {
    bands.push_back({.band = {"before", "m"}, .values = &before});
  }
  Draft draft(file);
  write_height_bands(draft.path(), bands, *input.coordinates.front(),
                     "difference of heights, m, and the heights of the ground");
  draft.take_its_place();
}

}  // namespace

VolumeOutcome volume_job(const VolumeCommandOptions& options,
                         const std::function<bool(const MergeStep&)>& on_step) {
  check_volume(options);
  VolumeInput input = volume_input(options, on_step);
  VolumeOutcome& outcome = input.outcome;
  const std::vector<Eigen::Vector2d>& polygon = input.selection.polygon;
  const GroundLevels after = ground_levels(input.after);
  const bool is_plane = !options.above.empty();
  const GroundPair pair =
      ground_pair(is_plane ? GroundLevels{} : ground_levels(input.before), after, kVolumeCell);
  const VolumeDifference difference = is_plane ? above_plane(options, pair.after, polygon, outcome)
                                               : compare_grounds(options, pair, polygon, outcome);
  const auto is_wanted = [&](const GroundHeights::Index& cell) {
    return polygon.empty() || is_within(polygon, difference.heights.middle(cell));
  };
  const double scale = plane_scale(input.after.front());
  const double square = kVolumeCell * kVolumeCell / (scale * scale);
  outcome.volume = ground_volume(difference.heights,
                                 {.stable = outcome.stable,
                                  .offset = outcome.offset,
                                  .offset_error = difference.offset_error,
                                  .square = square,
                                  .least_area = polygon.empty() ? kLeastChange : 0.0},
                                 is_wanted);
  if (outcome.volume.compared == 0.0) {
    throw UsageError(
        "no ground was seen both before and after within what --polygon and --box leave.");
  }
  const auto area_in = [&](const GroundHeights& ground) {
    return square * static_cast<double>(std::ranges::count_if(
                        ground.cells(), [&](const auto& cell) { return is_wanted(cell.first); }));
  };
  const double seen_before = is_plane ? 0.0 : area_in(pair.before.heights);
  const double seen_after = area_in(pair.after.heights);
  outcome.area = polygon.empty() ? seen_before + seen_after - outcome.volume.compared
                                 : area_of(polygon) / (scale * scale);
  outcome.unseen_before = is_plane ? 0.0 : std::max(0.0, outcome.area - seen_before);
  outcome.unseen_after = std::max(0.0, outcome.area - seen_after);
  for (const auto& [cell, height] : difference.heights.cells()) {
    const bool is_closed = pair.before.closed.contains(cell) || pair.after.closed.contains(cell);
    outcome.closed += is_closed && is_wanted(cell) ? square : 0.0;
  }
  outcome.cell = kVolumeCell;
  outcome.coordinates = input.coordinates.front()->name();
  outcome.has_place = !polygon.empty();
  if (options.raster) {
    write_raster(*options.raster, pair, difference, input);
  }
  return std::move(input.outcome);
}

}  // namespace adit
