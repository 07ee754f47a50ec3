// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "adit/tools/clouds/cloud_columns.hpp"

namespace adit {

/// Reads the element `vertex` of a PLY file, ASCII or binary of either byte order; x y z of any
/// numeric type, and intensity, ring and time where they are. Other elements and list properties
/// are skipped. What the file holds counts: another number of vertices in the header and lines that
/// cannot be read are faults of the result. Throws InputError where the header makes no sense or
/// not one vertex can be read. Memory is taken only for what the file can hold.
CloudFile read_ply(const std::filesystem::path& file, const CloudReading& reading = {});

/// The same from memory; `file` is for messages.
CloudFile parse_ply(const std::filesystem::path& file, std::string_view content,
                    const CloudReading& reading = {});

}  // namespace adit
