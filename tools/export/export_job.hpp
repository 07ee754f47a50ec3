// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the exports of `adit export` share: where the map lies, what is wanted of it, in which
// coordinates.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/export/export_options.hpp"
#include "adit/tools/map_changes/changed_space.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"
#include "adit/tools/setup/memory_limit.hpp"

namespace adit {

struct ExportJob {
  const MapDatabase* map = nullptr;
  const ExportCommandOptions* options = nullptr;
  std::filesystem::path file;                  ///< to write; it takes the place of the output later
  std::optional<Georeference> georeference{};  ///< of the map, or placed by hand
  std::shared_ptr<const MovedSpace> moved{};   ///< null: it was not looked for
  std::shared_ptr<const GoneSpace> gone{};     ///< the same
  const MemoryLimit* memory = nullptr;
  std::ostream* out = nullptr;  ///< what is found on the way
  std::ostream* err = nullptr;  ///< progress
};

/// Numbers with commas between them; nothing where one is none.
std::optional<std::vector<double>> parse_number_list(std::string_view text);

/// "LAT,LON,ALT[,YAW]": where the map's origin lies, and its x axis counter-clockwise from east
/// (degrees, m). Throws UsageError.
Georeference parse_origin(const std::string& text);

/// The frame that was asked for, otherwise UTM for formats that state what they are in and maps
/// that are georeferenced, otherwise the map's. Throws UsageError where the map is not
/// georeferenced, or the place not in the zone.
ProductCoordinates coordinates_of(const ExportJob& job, bool states_its_coordinates);
/// All frames. Throws UsageError where the map is not georeferenced.
ProductCoordinates earth_of(const ExportJob& job, const std::string& format);

/// By session, time, box, polygon. Throws UsageError, InputError of the polygon's file.
CloudSelection selection_of(const ExportJob& job, const ProductCoordinates& coordinates);

/// Throws OutputError where more memory is used than may be.
void require_within(const ExportJob& job);

/// ", in WGS 84 / UTM zone 30N, ..." for the report; nothing of the map's own frame.
std::string in_coordinates(const ProductCoordinates& coordinates);

}  // namespace adit
