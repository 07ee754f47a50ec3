// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/setup/device_session.hpp"

namespace adit {

/// What `adit export` is asked to write: one of trajectory, graph, cloud, dense, tiles, raster,
/// grid, report, picture and dump is set; tiles and cloud go together.
struct ExportCommandOptions {
  std::filesystem::path map{};

}  // namespace adit
