// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit align A B`: the relative pose of two clouds, or of many pairs.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/registration/cloud_aligner.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

class Command;

struct AlignCommandOptions {
  std::vector<std::string> clouds{};             ///< A and B, or nothing
  std::optional<std::filesystem::path> pairs{};  ///< a list of pairs instead
  std::vector<double> guess{};                   ///< of A and B: T_a_b, 4 or 7 numbers, or nothing
  CloudAlignerSettings settings{};
  std::optional<std::filesystem::path> picture{};  ///< PNG: b upon a
  DeviceOptions device{};
  bool json = false;
};

/// Aligns and reports. Returns the exit code: 0 done, 1 a cloud cannot be read or a pose was
/// refused, 2 usage.
int align_command(const AlignCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_align_command(Command app, std::function<void(int)> done);

}  // namespace adit
