// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit volume`: what was filled in or taken away between two maps of a place, or lies on a plane.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/export/export_options.hpp"
#include "adit/tools/map_changes/compared_maps.hpp"
#include "adit/tools/plans/ground_volume.hpp"

namespace adit {

struct VolumeCommandOptions {
  std::vector<std::filesystem::path> maps{};  ///< one or two: files, or folders of runs
  std::vector<int64_t> before{};              ///< sessions of one map; empty: the first
  std::vector<int64_t> after{};               ///< empty: the last
  std::string above{};                        ///< "HEIGHT" (m), "surroundings"; empty: compares
  bool as_georeferenced = false;              ///< two maps lie to each other as on the Earth
  bool as_measured = false;                   ///< no common offset of heights is taken off
  /// Of it box, polygon, frame, utm, crs, geoid, origin and device count.
  ExportCommandOptions place{};
  std::optional<std::filesystem::path> raster{};  ///< GeoTIFF; none: not written
  bool quiet = false;
  bool json = false;
};

enum class VolumeBase : uint8_t {
  tied,           ///< two maps, tied by places that both saw
  sessions,       ///< of one map
  georeferenced,  ///< two maps as they lie on the Earth
  height,         ///< a level plane
  surroundings,   ///< a plane through the ground around the polygon
};

struct VolumeOutcome {
  VolumeBase base = VolumeBase::tied;
  std::vector<ComparedSession> before{};  ///< sessions; empty: a plane
  std::vector<ComparedSession> after{};
  GroundVolume volume{};
  std::optional<StableGround> stable{};  ///< of surroundings: about the plane
  double offset = 0.0;                   ///< m, that was taken off the differences
  bool offset_refused = false;           ///< that of stable ground is larger than maps' errors are
  std::optional<double> tie_error{};     ///< m, standard deviation of the maps' relative height
  std::optional<GroundPlane> plane{};    ///< of height and surroundings
  double area = 0.0;                     ///< m2, of the polygon, or of what either saw
  double unseen_before = 0.0;            ///< m2 of that
  double unseen_after = 0.0;
  double closed = 0.0;        ///< m2 that were compared, but interpolated in one of both
  double cell = 0.0;          ///< m
  std::string coordinates{};  ///< for people
  bool has_place = false;     ///< a polygon or a box says what counts
};

/// Reads the maps and measures; writes the raster where one is wanted. `on_step` as of
/// compared_maps(). Throws as that, UsageError, InputError, OutputError.
VolumeOutcome volume_job(const VolumeCommandOptions& options,
                         const std::function<bool(const MergeStep&)>& on_step);

/// For people.
std::string describe_volume(const VolumeCommandOptions& options, const VolumeOutcome& outcome);
/// docs/schemas/volume.schema.json.
std::string to_json(const VolumeCommandOptions& options, const VolumeOutcome& outcome);

}  // namespace adit
