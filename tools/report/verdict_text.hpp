// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a run is worth, for people and for programs.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "adit/tools/report/run_assessment.hpp"

namespace adit {

/// A stretch, where it is, why it is not reliable and what to do; times from `start`.
std::string describe(const DoubtfulStretch& stretch, Nanoseconds start);

/// By how much loops moved the map, and what to do.
std::string describe(const MovedByLoops& moved);

/// "reliable: ...", or the state with its reasons and first stretches, one a line; lines after the
/// first are indented by `indent`.
std::string describe(const RunAssessment& assessment, Nanoseconds start, std::size_t indent);

/// `state`, `coverage`, `reasons` and `stretches`, these with their texts.
nlohmann::ordered_json to_json(const RunAssessment& assessment, Nanoseconds start);

}  // namespace adit
