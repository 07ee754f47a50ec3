// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "adit/tools/evaluation/evaluate.hpp"

namespace adit {

/// The evaluation as a table for people. Ends with a line break.
std::string format_evaluation(const Evaluation& evaluation, const std::filesystem::path& estimate,
                              const std::filesystem::path& truth);

/// The same as JSON, units in the names. Ends with a line break.
std::string evaluation_json(const Evaluation& evaluation, const std::filesystem::path& estimate,
                            const std::filesystem::path& truth);

}  // namespace adit
