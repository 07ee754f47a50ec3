// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

namespace adit {

/// An option or argument as it is on a command line.
struct GivenOption {
  std::string name;
  std::vector<std::string> values;     ///< none: it is not there
  bool written = false;                ///< CommandOption::written()
  std::vector<std::string> endings{};  ///< of a file to write, those that are taken; none: any
};

/// Throws UsageError where a file that is to be written is one that another option names.
void keep_inputs(std::span<const GivenOption> options);

/// Throws UsageError where the name of a file to write ends otherwise than it may.
void require_endings(std::span<const GivenOption> options);

}  // namespace adit
