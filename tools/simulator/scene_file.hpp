// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "adit/tools/simulator/simulation.hpp"

namespace adit {

/// Reads what to simulate from a TOML file: everything that `adit simulate` takes, and besides it
/// several range sensors, where sensors are mounted, and a way of one's own. `output` and `picture`
/// are left as they are by default. Throws InputError with line and column: syntax, unknown keys
/// (with the nearest that exists), wrong types, names that do not exist.
SimulationOptions read_scene_file(const std::filesystem::path& file);

/// An example of such a file that has every key, with its meaning, unit and default.
std::string scene_file_example();

}  // namespace adit
