// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/program.hpp"

#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "adit/tools/commands/command_config.hpp"
#include "adit/tools/commands/command_convert.hpp"
#include "adit/tools/commands/command_demo.hpp"
#include "adit/tools/commands/command_devices.hpp"
#include "adit/tools/commands/command_evaluate.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_guard.hpp"
#include "adit/tools/commands/command_info.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/commands/command_optimize.hpp"
#include "adit/tools/commands/command_recover.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/commands/command_simulate.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/option_values.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

constexpr int kUsage = 2;

/// What to tell about the words that neither the program nor the command knows; empty where there
/// are none. A missing argument is often a misspelt one, so this comes before what CLI11 complains
/// about.
std::string unknown_words(const CLI::App& app, const CLI::App& command) {
  std::vector<std::string> options;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_lnames().empty()) {
      options.push_back("--" + option->get_lnames().front());
    }
  }
  std::string text;
  for (const std::string& word : app.remaining(true)) {
    if (word.starts_with("--")) {
      const std::string name = word.substr(0, word.find('='));
      return "there is no option '" + name + "'. " + suggestion(name, options) + ".";
    }
    text += (text.empty() ? "not expected: " : " ") + word;
  }
  return text;
}

/// Help and version are answers, everything else that parsing throws is a mistake on the command
/// line.
int answer(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    return reported("adit", std::cout, std::cerr, app.exit(error, std::cout, std::cerr));
  }
  const CLI::App* command = &app;
  std::string name = "adit";
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    name += " " + command->get_name();
  }
  const std::string unknown = unknown_words(app, *command);
  std::cerr << name << ": " << (unknown.empty() ? plain_complaint(error) : unknown) << "\nRun `"
            << name << " --help` for what it takes.\n";
  return kUsage;
}

/// Says so when the first word is no command. CLI11 would only count it among the arguments it did
/// not expect.
bool is_unknown_command(const CLI::App& app, const char* word) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  if (std::string_view(word).starts_with('-') || std::ranges::count(names, word) > 0) {
    return false;
  }
  if (std::string_view(word) == "bench") {
    std::cerr << "adit: this program was built without its benchmarks. `./dev bench` in a checkout "
                 "builds it with them.\n";
    return true;
  }
  std::cerr << "adit: there is no command '" << word << "'. " << suggestion(word, names) << ".\n";
  return true;
}

int parse_and_run(int argc, const char* const* argv, std::span<const AddCommand> more) {
  CLI::App app("Range-inertial SLAM on any Vulkan device", "adit");
  app.set_version_flag("--version", "adit " + std::string(version()));
  app.footer(
      "Examples:\n"
      "  adit demo                        see it work, without data\n"
      "  adit run drive/ -o out           map a recording\n"
      "  adit evaluate out/trajectory.tum truth.txt\n\n"
      "`adit COMMAND --help` tells more. Exit codes: 0 done, 1 failed on the data or the device, 2 "
      "usage,\n129, 130 or 143 stopped by SIGHUP, SIGINT (Ctrl-C) or SIGTERM.");
  app.require_subcommand(1);
  int code = 0;
  const auto done = [&code](int command_code) { code = command_code; };
  add_demo_command(app, done);
  add_run_command(app, done);
  add_simulate_command(app, done);
  add_inspect_command(app, done);
  add_convert_command(app, done);
  add_evaluate_command(app, done);
  add_info_command(app, done);
  add_check_command(app, done);
  add_recover_command(app, done);
  add_export_command(app, done);
  add_optimize_command(app, done);
  add_devices_command(app, done);
  add_config_command(app, done);
  for (const AddCommand& add : more) {
    add(app, done);
  }

  if (argc < 2) {
    std::cerr << app.help();
    return kUsage;
  }
  if (is_unknown_command(app, argv[1])) {
    return kUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return answer(app, error);
  }
  return code;
}

}  // namespace

int program(int argc, const char* const* argv, std::span<const AddCommand> more) {
  try {
    return parse_and_run(argc, argv, more);
  } catch (const std::exception& error) {
    std::cerr << "adit: " << error.what() << std::endl;
  } catch (...) {
    std::cerr << "adit: an unknown error" << std::endl;
  }
  return 1;
}

}  // namespace adit
