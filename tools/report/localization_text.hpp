// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/mapping/localization.hpp"

namespace adit {

/// What a run came to know of its place in an earlier map, for programs and for people.
nlohmann::ordered_json to_json(const Localization& localization);
std::string describe(const Localization& localization);

}  // namespace adit
