// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit recover MAP -o NEW`.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace CLI {
class App;
}

namespace adit {

struct RecoverCommandOptions {
  std::filesystem::path map{};
  std::filesystem::path output{};
};

/// Writes what is whole of a damaged map into a new one. Returns the exit code: 0 all of it was,
/// 1 something is lost or nothing can be read, 2 usage.
int recover_command(const RecoverCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr at the end of CLI parsing; `done` gets
/// the exit code.
CLI::App* add_recover_command(CLI::App& app, std::function<void(int)> done);

}  // namespace adit
