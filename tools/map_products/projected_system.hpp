// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Projected coordinate reference systems by name, as PROJ knows them. PROJ is looked for when one
// is asked for: adit runs without it. projected_system.cpp is the one file that sees it.
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <Eigen/Core>

#include "adit/slam/core/types.hpp"

namespace adit {

/// A coordinate reference system that cannot be used. what() says why and what to do.
class NoSuchSystem : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A projected system: east and north in metres. A value; copies share PROJ's own.
class ProjectedSystem {
 public:
  /// "EPSG:25830", or whatever else PROJ takes: a name, WKT, PROJJSON. Throws NoSuchSystem: PROJ is
  /// not installed, knows no such system, or it is none of east and north in metres.
  explicit ProjectedSystem(const std::string& definition);

  /// "ETRS89 / UTM zone 30N".
  const std::string& name() const;
  /// Its number in EPSG's register; nothing where it has none.
  std::optional<int> epsg() const;
  /// OGC WKT 1, as GDAL writes it.
  const std::string& wkt() const;

  /// East and north, m. Throws NoSuchSystem where it does not cover the place.
  Eigen::Vector2d position_of(const Geodetic& place) const;
  /// And back; `altitude` is above the ellipsoid. Throws NoSuchSystem likewise.
  Geodetic place_of(const Eigen::Vector2d& position, double altitude) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace adit
