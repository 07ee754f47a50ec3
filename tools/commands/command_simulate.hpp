// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit simulate SCENE -o FILE.mcap`.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

#include "adit/tools/simulator/simulation.hpp"

namespace CLI {
class App;
}

namespace adit {

struct SimulateCommandOptions {
  SimulationOptions simulation;
  std::string layout;                ///< empty: the driver's
  bool perfect = false;              ///< none of the range sensor's errors
  bool quiet = false;                ///< errors alone
  std::string besides_scene_file{};  ///< an option that a scene file excludes; empty: none
};

/// Simulates and tells what was written. Returns the exit code: 0 done, 1 failed, 2 usage.
int simulate_command(const SimulateCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr at the end of CLI parsing; `done` gets
/// the exit code.
CLI::App* add_simulate_command(CLI::App& app, std::function<void(int)> done);

}  // namespace adit
