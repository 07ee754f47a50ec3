// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit simulate SCENE -o FILE.mcap`.
#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/simulator/simulation.hpp"

namespace adit {

class Command;

struct SimulateCommandOptions {
  SimulationOptions simulation;
  std::string layout;                  ///< empty: the driver's
  std::vector<std::string> cameras{};  ///< NAME or NAME:LENS
  std::optional<int> camera_rate{};    ///< Hz; none: CameraOptions::rate
  bool perfect = false;                ///< none of the range sensor's errors
  bool overwrite = false;              ///< replace a file that no simulation wrote, too
  bool quiet = false;                  ///< errors alone
  std::string besides_scene_file{};    ///< an option that a scene file excludes; empty: none
};

/// Simulates and tells what was written. Returns the exit code: 0 done, 1 failed, 2 usage.
int simulate_command(const SimulateCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_simulate_command(Command app, std::function<void(int)> done);

}  // namespace adit
