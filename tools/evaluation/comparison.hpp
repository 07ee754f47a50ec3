// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Several estimates beside one truth: a table for people, papers and programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

struct ComparedEstimate {
  std::string name;
  std::optional<Evaluation> evaluation;  ///< none: it could not be compared
  std::string note;                      ///< why, or that its run did not complete; may be empty
};

struct Comparison {
  std::string truth;
  std::vector<ComparedEstimate> estimates;

  bool complete() const;  ///< every estimate could be compared
};

enum class TableFormat { text, markdown, latex, csv };

/// The shortest ends of the paths that tell them apart.
std::vector<std::string> short_names(const std::vector<std::filesystem::path>& paths);

/// A line an estimate. Where there are several, the least of each error is marked (with a star,
/// or in bold). CSV has all digits and units in the names; what is not known is empty there and
/// "-" elsewhere. Ends with a line break.
std::string to_table(const Comparison& comparison, TableFormat format);

/// What is noted of the estimates, a line each, for people.
std::string notes_of(const Comparison& comparison);

}  // namespace adit
