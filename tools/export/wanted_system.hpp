// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

/// What --utm, --crs and --geoid ask for. Throws UsageError: no such zone, system or file.
ProductSystem wanted_system(const std::optional<std::string>& utm,
                            const std::optional<std::string>& crs,
                            const std::optional<std::filesystem::path>& geoid);

/// Throws UsageError, which names what of `given` cannot be, where no world frame has its origin.
void require_place(const std::string& given, const Geodetic& place);

}  // namespace adit
