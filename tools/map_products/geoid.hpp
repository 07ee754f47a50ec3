// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Heights above the sea, of a file. geoid.cpp sees that part of GeographicLib, and nothing else
// does.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "adit/slam/core/types.hpp"

namespace adit {

/// How far the geoid lies above the WGS 84 ellipsoid, from a file in GeographicLib's format
/// (egm96-5.pgm, egm2008-1.pgm), interpolated by cubic polynomials. A value; copies share the file.
class Geoid {
 public:
  /// Throws std::invalid_argument: the file cannot be read, or is none.
  explicit Geoid(const std::filesystem::path& file);

  /// The file's name without its ending: "egm2008-1".
  const std::string& name() const { return name_; }
  /// m; positive where the geoid is above the ellipsoid. Throws std::invalid_argument where the
  /// file ends before it tells.
  double height_at(const Geodetic& place) const;
  /// Above the geoid, m.
  double orthometric(const Geodetic& place) const { return place.altitude - height_at(place); }

 private:
  struct State;
  std::string name_;
  std::shared_ptr<const State> state_;
};

}  // namespace adit
