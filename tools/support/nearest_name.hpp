// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace adit {

/// Letters to insert, delete, replace or swap with a neighbour to get from one word to the other
/// (optimal string alignment distance).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// What to tell someone who wrote `given` where one of `valid` was expected: "The nearest valid
/// name is 'x'", or "Valid are x, y, z" where none is near. `before` is put before each name that
/// is shown ("mapping."). No full stop at the end.
std::string suggestion(std::string_view given, const std::vector<std::string>& valid,
                       const std::string& before = {});

}  // namespace adit
