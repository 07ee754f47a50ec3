// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run is worth, for people and for programs.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/odometry/verdict.hpp"

namespace adit {

/// A stretch, where it is, why it is not reliable and what to do; times from `start`.
std::string describe(const DoubtfulStretch& stretch, Nanoseconds start);

/// "reliable: ...", or the state with its first stretches, one a line; lines after the first are
/// indented by `indent`.
std::string describe(const Verdict& verdict, Nanoseconds start, std::size_t indent);

/// `state` and `stretches`, each with its text.
nlohmann::ordered_json to_json(const Verdict& verdict, Nanoseconds start);

}  // namespace adit
