// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit loops MAP`: the places that were seen again, and what became of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <vector>

#include "adit/tools/setup/device_session.hpp"

namespace adit {

class Command;

struct LoopsCommandOptions {
  std::filesystem::path map{};
  std::optional<int64_t> revoke{};   ///< an accepted loop that is to be taken back
  std::optional<int64_t> restore{};  ///< one that was
  std::vector<int64_t> add{};        ///< two keyframes between which there is a loop, or nothing
  std::vector<double> guess{};       ///< how they lie: x, y, z (m), yaw (degrees), or nothing
  DeviceOptions device{};            ///< that verifies it
  std::optional<std::filesystem::path> html{};  ///< a page that shows them
  std::vector<int64_t> show{};                  ///< those that it draws, or nothing: an even choice
  bool json = false;
};

/// Lists the candidates of a map; revokes or restores one of them first, or adds one, and optimises
/// the map anew. Returns the exit code: 0 done, 1 the file is no map that can be read or written,
/// or what was to be added is none, 2 no such loop or keyframe.
int loops_command(const LoopsCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_loops_command(Command app, std::function<void(int)> done);

}  // namespace adit
