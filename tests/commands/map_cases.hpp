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

/// Puts a byte into one number of one row, as a disk may do: the database itself stays sound.
void damage_row(const std::filesystem::path& map, Dice& dice);

/// Calls info, check, loops, export, optimize, merge or recover on `map`, which `healthy` was
/// before it was damaged. What they write goes into `folder`/out. Returns the command's code, or
/// one that none has where check calls a map whole that holds something else than the healthy one.
int call_on_map(const std::filesystem::path& map, const std::filesystem::path& healthy,
                const std::filesystem::path& folder, engine::Context& context, Dice& dice,
                std::ostream& told);

/// Calls optimize on a graph's file.
int call_on_graph(const std::filesystem::path& graph, const std::filesystem::path& folder,
                  Dice& dice, std::ostream& told);

}  // namespace adit::test
