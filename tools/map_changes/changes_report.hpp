// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit changes` reports.
#pragma once

#include <filesystem>
#include <string>

#include "adit/tools/map_changes/changes_job.hpp"

namespace adit {

/// The table for people.
std::string describe_changes(const ChangesCommandOptions& options, const ChangesOutcome& outcome);
/// docs/schemas/changes.schema.json.
std::string to_json(const ChangesCommandOptions& options, const ChangesOutcome& outcome);
/// GeoJSON: a Polygon each, the footprint of the object's box at its bottom. In degrees on WGS 84
/// where the map is georeferenced (RFC 7946), else in metres of the map's frame, which the file
/// then says. Throws OutputError.
void write_changes_geojson(const std::filesystem::path& file, const ChangesOutcome& outcome);

}  // namespace adit
