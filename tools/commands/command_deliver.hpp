// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit deliver MAP|OUT -o FOLDER`: all that a client gets of a map.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>

#include "adit/tools/export/delivery.hpp"

namespace adit {

class Command;

struct DeliverCommandOptions {
  std::filesystem::path map{};     ///< or the folder of its run
  std::filesystem::path folder{};  ///< that is made, or completed
  std::optional<std::filesystem::path> preset{};
  DeliveryPlace place{};
  bool print_preset = false;
};

/// Writes what is not there yet. Returns the exit code: 0 all is there, 1 the map cannot be read or
/// a file not written, 2 usage. What one file fails of does not stop the others.
int deliver_command(const DeliverCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_deliver_command(Command app, std::function<void(int)> done);

}  // namespace adit
