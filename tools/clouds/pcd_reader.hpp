// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include "adit/tools/clouds/cloud_columns.hpp"

namespace adit {

/// Reads a PCD file: ASCII, binary or binary_compressed; x y z of any numeric type, and intensity,
/// ring and time where they are. What the file holds counts: other numbers of points in the header
/// and lines that cannot be read are faults of the result. Throws InputError where the header makes
/// no sense or not one point can be read. Memory is taken only for what the file can hold.
CloudFile read_pcd(const std::filesystem::path& file, const CloudReading& reading = {});

/// The same from memory; `file` is for messages.
CloudFile parse_pcd(const std::filesystem::path& file, std::string_view content,
                    const CloudReading& reading = {});

}  // namespace adit
