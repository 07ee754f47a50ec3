// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Commands on maps take the map's file or the folder that a run wrote it to.
#pragma once

#include <filesystem>

namespace adit {

/// OUT/map.adit where `what` is a folder OUT, otherwise `what` itself. It need not exist.
std::filesystem::path map_file(const std::filesystem::path& what);

/// map_file() of what a command is given. Throws InputError where no such file exists: it says why
/// the run in that folder made no map, and how to make one.
std::filesystem::path find_map(const std::filesystem::path& what);

}  // namespace adit
