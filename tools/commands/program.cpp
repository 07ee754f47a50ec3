// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/program.hpp"

#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "adit/engine/loader.hpp"
#include "adit/tools/commands/command_align.hpp"
#include "adit/tools/commands/command_config.hpp"
#include "adit/tools/commands/command_convert.hpp"
#include "adit/tools/commands/command_demo.hpp"
#include "adit/tools/commands/command_devices.hpp"
#include "adit/tools/commands/command_evaluate.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_guard.hpp"
#include "adit/tools/commands/command_info.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/commands/command_line.hpp"
#include "adit/tools/commands/command_loops.hpp"
#include "adit/tools/commands/command_optimize.hpp"
#include "adit/tools/commands/command_recover.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/commands/command_simulate.hpp"
#include "adit/tools/commands/command_view.hpp"
#include "adit/tools/support/commit.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

constexpr int kUsage = 2;

/// Says so when the first word is no command. CLI11 would only count it among the arguments it did
/// not expect.
bool is_unknown_command(const CommandLine& line, const std::string& word) {
  const std::vector<std::string> names = line.commands();
  if (word.starts_with('-') || std::ranges::count(names, word) > 0) {
    return false;
  }
  if (word == "bench") {
    std::cerr << "adit: this program was built without its benchmarks. `./dev bench` in a checkout "
                 "builds it with them.\n";
    return true;
  }
  std::cerr << "adit: there is no command '" << word << "'. " << suggestion(word, names) << ".\n";
  return true;
}

std::string version_text() {
  return fmt::format("adit {}\ncommit   {}\ncompiler {}\nloader   {}", version(), commit(),
                     compiler(),
                     engine::loader_version().value_or("no libvulkan.so.1 on this machine"));
}

/// `adit help COMMAND` is `adit COMMAND --help`, and `adit help` `adit --help`.
std::vector<const char*> without_help_word(int argc, const char* const* argv) {
  std::vector<const char*> words(argv, argv + argc);
  if (argc > 1 && std::string_view(argv[1]) == "help") {
    words.erase(words.begin() + 1);
    words.push_back("--help");
  }
  return words;
}

int parse_and_run(int argc, const char* const* argv, std::span<const AddCommand> more) {
  const CommandLine line("adit", "Range-inertial SLAM on any Vulkan device");
  line.version(version_text);
  const Command app = line.program();
  app.footer(
      "Examples:\n"
      "  adit demo                        see it work, without data\n"
      "  adit run drive/ -o out           map a recording\n"
      "  adit evaluate out/trajectory.tum truth.txt\n\n"
      "`adit help COMMAND` tells more. Exit codes: 0 done, 1 failed on the data or the device, 2 "
      "usage,\n129, 130 or 143 stopped by SIGHUP, SIGINT (Ctrl-C) or SIGTERM.");
  int code = 0;
  const auto done = [&code](int command_code) { code = command_code; };
  add_demo_command(app, done);
  add_run_command(app, done);
  add_simulate_command(app, done);
  add_inspect_command(app, done);
  add_convert_command(app, done);
  add_align_command(app, done);
  add_evaluate_command(app, done);
  add_info_command(app, done);
  add_check_command(app, done);
  add_recover_command(app, done);
  add_view_command(app, done);
  add_export_command(app, done);
  add_loops_command(app, done);
  add_optimize_command(app, done);
  add_devices_command(app, done);
  add_config_command(app, done);
  for (const AddCommand& add : more) {
    add(app, done);
  }

  if (argc < 2) {
    std::cerr << line.help();
    return kUsage;
  }
  const std::vector<const char*> words = without_help_word(argc, argv);
  if (is_unknown_command(line, words[1])) {
    return kUsage;
  }
  return line.run(static_cast<int>(words.size()), words.data()).value_or(code);
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
