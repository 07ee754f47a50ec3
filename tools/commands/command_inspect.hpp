// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit inspect RECORDING`, `adit inspect OUT`.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>

#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

class Command;

struct InspectCommandOptions {
  std::filesystem::path recording;                          ///< or the folder of a run
  std::vector<std::filesystem::path> further_recordings{};  ///< parts of it that follow in time
  DeviceOptions device{};                               ///< to compare the sensors' rotations on
  ConfigSource config{};                                ///< how the recording is to be understood
  std::optional<std::filesystem::path> html{};          ///< for a page with plots
  std::optional<std::filesystem::path> write_config{};  ///< for one that makes up for its faults
  bool json = false;                                    ///< JSON on `out` instead of the table
};

/// Reads all of a recording and tells on `out` what is in it and what is wrong with it. Returns the
/// exit code: 0 no fault found, 1 a problem found, or it cannot be opened. Of the folder of a run
/// it tells how that went; 0 where that can be read.
int inspect_command(const InspectCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_inspect_command(Command app, std::function<void(int)> done);

}  // namespace adit
