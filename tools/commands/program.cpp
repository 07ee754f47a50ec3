// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/program.hpp"

#include <algorithm>
#include <exception>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "adit/engine/loader.hpp"
#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/console.hpp"
#include "adit/tools/commands/command_align.hpp"
#include "adit/tools/commands/command_changes.hpp"
#include "adit/tools/commands/command_config.hpp"
#include "adit/tools/commands/command_convert.hpp"
#include "adit/tools/commands/command_deliver.hpp"
#include "adit/tools/commands/command_demo.hpp"
#include "adit/tools/commands/command_devices.hpp"
#include "adit/tools/commands/command_evaluate.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_generate.hpp"
#include "adit/tools/commands/command_info.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/commands/command_live.hpp"
#include "adit/tools/commands/command_loops.hpp"
#include "adit/tools/commands/command_merge.hpp"
#include "adit/tools/commands/command_optimize.hpp"
#include "adit/tools/commands/command_plan.hpp"
#include "adit/tools/commands/command_record.hpp"
#include "adit/tools/commands/command_recover.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/commands/command_shard.hpp"
#include "adit/tools/commands/command_simulate.hpp"
#include "adit/tools/commands/command_split.hpp"
#include "adit/tools/commands/command_view.hpp"
#include "adit/tools/commands/command_volume.hpp"
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
  return fmt::format("adit {}\ncommit   {}\nbuild    {}\ncompiler {}\nloader   {}", version(),
                     commit(), build_type(), compiler(),
                     engine::loader_version().value_or("no libvulkan.so.1 on this machine"));
}

/// `adit help COMMAND` is `adit COMMAND --help`, and `adit help` `adit --help`.
std::vector<const char*> without_help_word(std::span<const char* const> given) {
  std::vector<const char*> words(given.begin(), given.end());
  const std::string_view next = words.size() > 2 ? words[2] : "";
  const bool of_help_itself = next == "-h" || next == "--help";
  if (words.size() > 1 && std::string_view(words[1]) == "help" && !of_help_itself) {
    words.erase(words.begin() + 1);
    words.push_back("--help");
  }
  return words;
}

/// For what lists the commands: the words of a command line with `help` are turned round before.
void add_help_command(Command app, const std::vector<std::string>& commands) {
  const Command command = app.add_command("help", "Tell what a command does and takes");
  const auto words = std::make_shared<std::vector<std::string>>();
  command.footer("Example:\n  adit help run\n\nExit codes: 0 done, 2 usage.");
  command.option("command", *words, "Which; without it, all of them")
      .value_name("COMMAND")
      .suggest(commands);
  command.action([words] {});
}

int parse_and_run(std::span<const char* const> given, std::span<const AddCommand> more,
                  Console& console) {
  const CommandLine line("adit", "Range-inertial SLAM on any Vulkan device");
  line.version(version_text);
  const Command app = line.program();
  app.footer(
      "Examples:\n"
      "  adit demo                        see it work, without data\n"
      "  adit run drive/ -o out           map a recording\n"
      "  adit evaluate out/trajectory.tum truth.txt\n\n"
      "`adit help COMMAND` tells more. Settings come from the file that --config names and from "
      "--set;\nno other file is read.\n\n"
      "Environment:\n"
      "  ADIT_DEVICE     the device where --device names none\n"
      "  XDG_CACHE_HOME  where what is found out about devices is kept; otherwise ~/.cache\n"
      "  NO_COLOR        no colours, unless --color asks for them\n"
      "  CLICOLOR_FORCE  colours, wherever the output goes\n\n"
      "Exit codes: 0 done, 1 failed on the data or the device, 2 usage, 129, 130 or 143 stopped "
      "by\n"
      "SIGHUP, SIGINT (Ctrl-C) or SIGTERM.");
  int code = 0;
  const auto done = [&code](int command_code) { code = command_code; };
  add_demo_command(app, done);
  add_run_command(app, done);
  add_live_command(app, done);
  add_record_command(app, done);
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
  add_deliver_command(app, done);
  add_loops_command(app, done);
  add_optimize_command(app, done);
  add_merge_command(app, done);
  add_split_command(app, done);
  add_plan_command(app, done);
  add_shard_command(app, done);
  add_changes_command(app, done);
  add_volume_command(app, done);
  add_devices_command(app, done);
  add_config_command(app, done);
  add_generate_command(
      app, [&line] { return line.description(); }, done);
  for (const AddCommand& add : more) {
    add(app, done);
  }
  add_help_command(app, line.commands());
  ConsoleOptions options;
  for (const Command command : line.all()) {
    add_console_options(command, options);
  }

  if (given.size() < 2) {
    std::cerr << line.help();
    return kUsage;
  }
  const std::vector<const char*> words = without_help_word(given);
  if (is_unknown_command(line, words[1])) {
    return kUsage;
  }
  const std::optional<int> ended = line.run(static_cast<int>(words.size()), words.data(),
                                            [&] { console.begin(options, given); });
  return ended ? *ended : console.end(code);
}

}  // namespace

int program(int argc, const char* const* argv, std::span<const AddCommand> more) {
  const std::span<const char* const> words(argv, static_cast<std::size_t>(argc));
  Console console(color_among(words));
  try {
    return parse_and_run(words, more, console);
  } catch (const std::exception& error) {
    std::cerr << "adit: " << error.what() << std::endl;
  } catch (...) {
    std::cerr << "adit: an unknown error" << std::endl;
  }
  return 1;
}

}  // namespace adit
