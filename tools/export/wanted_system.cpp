// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/wanted_system.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/slam/gnss/world_frame.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

Geoid geoid_of(const std::filesystem::path& file) {
  try {
    return Geoid(file);
  } catch (const std::invalid_argument& error) {
    throw UsageError("--geoid " + file.string() + ": it cannot be used (" + error.what() +
                     "). Expected a file of GeographicLib's, such as egm2008-1.pgm "
                     "(geographiclib-get-geoids fetches them).");
  }
}

}  // namespace

ProductSystem wanted_system(const std::optional<std::string>& utm,
                            const std::optional<std::string>& crs,
                            const std::optional<std::filesystem::path>& geoid) {
  ProductSystem system;
  if (utm) {
    system.zone = parse_utm_zone(*utm);
    if (!system.zone) {
      throw UsageError("--utm " + *utm + ": expected a zone from 1 to 60 and N or S, such as 30N.");
    }
  }
  try {
    if (crs) {
      system.named.emplace(*crs);
    }
  } catch (const NoSuchSystem& error) {
    throw UsageError("--crs " + *crs + ": " + error.what() + ".");
  }
  if (geoid) {
    system.geoid = geoid_of(*geoid);
  }
  return system;
}

void require_place(const std::string& given, const Geodetic& place) {
  const auto require = [&given](const char* name, double value, double most) {
    if (!(std::abs(value) <= most)) {
      throw UsageError(fmt::format(
          "{}: its {} is {}; latitudes within {} degrees, longitudes within 180 and heights within "
          "{} m are possible.",
          given, name, shortest(value), kMostLatitude, kMostAltitude));
    }
  };
  require("latitude", place.latitude, kMostLatitude);
  require("longitude", place.longitude, 180.0);
  require("height", place.altitude, kMostAltitude);
}

}  // namespace adit
