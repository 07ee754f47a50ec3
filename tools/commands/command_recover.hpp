// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit recover MAP|OUT -o NEW`.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace adit {

class Command;

struct RecoverCommandOptions {
  std::filesystem::path map{};  ///< or the folder of its run
  std::filesystem::path output{};
};

/// Writes what is whole of a damaged map into a new one. Returns the exit code: 0 all of it was,
/// 1 something is lost or nothing can be read, 2 usage.
int recover_command(const RecoverCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_recover_command(Command app, std::function<void(int)> done);

}  // namespace adit
