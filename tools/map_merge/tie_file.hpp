// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What ties two maps, as a file: pairs of maps are searched by one machine and joined by another.
#pragma once

#include <filesystem>
#include <string>

#include "adit/slam/mapping/map_ties.hpp"

namespace adit {

/// JSON; each number reads back as the same one.
std::string to_json(const MapTie& tie);

/// What to_json() has written; the maps get the numbers `one` and `other`. Throws InputError where
/// the file holds something else.
MapTie read_tie(const std::filesystem::path& file, std::size_t one, std::size_t other);

}  // namespace adit
