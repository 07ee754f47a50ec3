// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit shard`: one piece of a plan's work.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <ostream>
#include <string>

#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

struct ShardCommandOptions {
  std::filesystem::path plan{};
  std::string which{};  ///< a number, or an id; empty: what the environment says
  std::string stage{};  ///< numbers count within it
  bool all = false;
  bool tolerant = false;            ///< a shard that has failed is no failure of the command
  std::filesystem::path into{};     ///< does the work here, and leaves its result there
  std::filesystem::path program{};  ///< adit; empty: this one
  DeviceOptions device{};
};

/// The whole command. Returns its exit code.
int shard_command(const ShardCommandOptions& options, std::ostream& out, std::ostream& err);
/// Adds the command to `app`; `done` gets the exit code.
void add_shard_command(Command app, std::function<void(int)> done);

}  // namespace adit
