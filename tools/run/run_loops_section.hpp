// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the pages of a run say of its loops.
#pragma once

#include <string>

#include "adit/tools/results/run_outputs.hpp"

namespace adit {

/// A part of a page about loops.
struct LoopsSection {
  std::string headline;  ///< "65 of 102 loops accepted"
  std::string body;      ///< HTML
};

/// Loops accepted and refused by reason, the drift before and after them, and the graph. Empty
/// where the run has no map, or no loop was found; a map that cannot be read is said.
LoopsSection run_loops_section(const RunFiles& files);

}  // namespace adit
