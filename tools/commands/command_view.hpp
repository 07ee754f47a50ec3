// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit view MAP`: a page for a browser, served by the program itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>

namespace adit {

class Command;

struct ViewCommandOptions {
  std::filesystem::path what{};      ///< a map, a run's folder, or a cloud
  std::string listen = "127.0.0.1";  ///< address; others than loopback ask for a token
  uint32_t port = 0;                 ///< 0: any that is free
  bool edit = false;                 ///< loops may be revoked and restored
};

/// Serves until a signal ends it. Returns the exit code: 0 ended by SIGINT (Ctrl-C) or SIGTERM, 1
/// nothing that can be shown, or this build has no page, 2 usage.
int view_command(const ViewCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_view_command(Command app, std::function<void(int)> done);

}  // namespace adit
