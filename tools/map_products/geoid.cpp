// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/geoid.hpp"

#include <stdexcept>

#include <GeographicLib/Geoid.hpp>

namespace adit {

struct Geoid::State {
  State(const std::string& name, const std::string& folder) : grid(name, folder) {}
  GeographicLib::Geoid grid;
};

Geoid::Geoid(const std::filesystem::path& file) : name_(file.stem().string()) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (file.extension() != ".pgm") {
    throw std::invalid_argument("a geoid is a file NAME.pgm, as GeographicLib has them");
  }
  try {
    state_ = std::make_shared<const State>(name_, folder.string());
  } catch (const GeographicLib::GeographicErr& error) {
    throw std::invalid_argument(error.what());
  }
}

double Geoid::height_at(const Geodetic& place) const {
  try {
    return state_->grid(place.latitude, place.longitude);
  } catch (const std::exception& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace adit
