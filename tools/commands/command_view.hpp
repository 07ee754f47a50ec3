// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit view MAP`: a page for a browser, served by the program itself.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>

#include "adit/tools/run/served_page.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

class Command;

struct ViewCommandOptions {
  std::filesystem::path what{};  ///< a map, a run's folder, or a cloud
  ServeOptions serve{};
  DeviceOptions device{};  ///< that recordings are mapped, loops verified and points coloured on
  bool edit = false;       ///< loops may be revoked, restored and proposed
  std::optional<std::filesystem::path> truth{};  ///< a trajectory with times
  bool color = false;  ///< a map's points, by the cameras of its recording
  std::optional<std::filesystem::path> recording{};    ///< for the colours; none: that of the map
  std::optional<std::filesystem::path> calibration{};  ///< a file of cameras
};

/// Serves until a signal ends it. Returns the exit code: 0 ended by SIGINT (Ctrl-C) or SIGTERM, 1
/// nothing that can be shown, or this build has no page, 2 usage.
int view_command(const ViewCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_view_command(Command app, std::function<void(int)> done);

}  // namespace adit
