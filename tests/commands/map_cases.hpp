// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A small map and a pose graph, and the commands on maps with options at random.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "adit/engine/context.hpp"
#include "adit/tests/commands/mutations.hpp"

namespace adit::test {

/// Writes `map.adit`, six keyframes with a wall each and a loop, and `graph.g2o`, its graph.
void write_healthy_map(const std::filesystem::path& folder);

/// Calls info, check, loops, export, optimize or recover. What they write goes into `folder`/out.
/// Returns the command's code.
int call_on_map(const std::filesystem::path& map, const std::filesystem::path& folder,
                engine::Context& context, Dice& dice, std::ostream& told);

/// Calls optimize on a graph's file.
int call_on_graph(const std::filesystem::path& graph, const std::filesystem::path& folder,
                  Dice& dice, std::ostream& told);

}  // namespace adit::test
