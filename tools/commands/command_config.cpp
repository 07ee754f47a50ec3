// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_config.hpp"

#include <iostream>
#include <memory>
#include <utility>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/setup/presets.hpp"

namespace adit {

int config_command(const ConfigSource& source, std::ostream& out, std::ostream& err) {
  return guarded("adit config", out, err, [&] {
    out << to_toml(load_config(source)) << std::flush;
    return 0;
  });
}

void add_config_command(Command app, std::function<void(int)> done) {
  auto source = std::make_shared<ConfigSource>();
  const Command command = app.add_command(
      "config", "Print the effective configuration, each setting with unit and meaning");
  command.footer(
      "What it prints is a configuration file that gives the same configuration.\n\n"
      "Examples:\n"
      "  adit config > my.toml\n"
      "  adit config --config my.toml --set preprocess.r_input=0.5\n\n"
      "Exit codes: 0 done, 1 a file cannot be read or what is printed not be written, 2 usage.");
  add_config_options(command, *source);
  command.action(
      [source, done = std::move(done)] { done(config_command(*source, std::cout, std::cerr)); });
}

}  // namespace adit
