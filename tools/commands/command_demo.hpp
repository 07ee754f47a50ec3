// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit demo`: simulate a drive through a mine, map it, evaluate it, and say where to look.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

#include "adit/tools/setup/device_session.hpp"

namespace adit {

class Command;

/// The demo fails above this absolute trajectory error (m, rmse after alignment).
inline constexpr double kDemoErrorBound = 0.03;

struct DemoCommandOptions {
  std::filesystem::path output = "adit-demo";
  double duration = 64.0;  ///< s of the simulated recording
  DeviceOptions device;
  bool quiet = false;  ///< errors alone
};

/// Returns the exit code: 0 done, 1 failed or less accurate than kDemoErrorBound, 2 usage, 128 +
/// signal when stopped.
int demo_command(const DemoCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_demo_command(Command app, std::function<void(int)> done);

}  // namespace adit
