// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "adit/tools/clouds/cloud_columns.hpp"

namespace adit {

/// Reads a LAS file, versions 1.0 to 1.4, point formats 0 to 10 (ASPRS LAS 1.4 R15), or one that is
/// packed (LAZ, COPC), formats 0 to 3 and 6 to 10, with intensity and, where the format has it, GPS
/// time. Coordinates are those of the file less Sweep::offset, m.
/// What the file holds counts: another number of points in the header is a fault of the result.
/// Throws InputError: damaged, without a whole point, or packed in
/// another way.
CloudFile read_las(const std::filesystem::path& file, const CloudReading& reading = {});

/// The same of a file's content; `file` is for messages.
CloudFile parse_las(const std::filesystem::path& file, std::string_view content,
                    const CloudReading& reading = {});

}  // namespace adit
