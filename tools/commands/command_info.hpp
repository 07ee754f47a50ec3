// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit info MAP|OUT` and `adit check MAP|OUT`: what a map holds, and whether it is whole.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace adit {

class Command;

struct InfoCommandOptions {
  std::filesystem::path map{};  ///< or the folder of its run
  bool json = false;
};

/// Says what a map holds. Returns the exit code: 0 done, 1 the file is no map that can be read.
int info_command(const InfoCommandOptions& options, std::ostream& out, std::ostream& err);

/// Reads all of a map. Returns the exit code: 0 it is whole, 1 it is not, and `out` says where.
int check_command(const InfoCommandOptions& options, std::ostream& out, std::ostream& err);

/// Add the sub-commands. They run on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_info_command(Command app, std::function<void(int)> done);
void add_check_command(Command app, std::function<void(int)> done);

}  // namespace adit
