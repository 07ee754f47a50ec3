// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_split.hpp"

#include <iostream>
#include <memory>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"

namespace adit {

int split_command(const SplitCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit split", out, err, [&] {
    const SplitOutcome outcome = split_job(options);
    out << (options.json ? to_json(options, outcome) : describe(options, outcome));
    return 0;
  });
}

void add_split_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command("split", "Write sessions of a map as a map of their own");
  const auto options = std::make_shared<SplitCommandOptions>();
  command.footer(
      "OUT is the folder of a run, MAP the map in it, OUT/map.adit. `adit info MAP` prints the "
      "numbers of its sessions.\n"
      "The new map has the sessions' keyframes and what lies among them: edges, loops, GNSS fixes, "
      "control points. Poses stay as they are, in the frame of MAP and at its place in the world. "
      "To take a session out of a map, name all others.\n\n"
      "Examples:\n"
      "  adit split site.adit --session 2 -o tuesday.adit\n"
      "  adit split site.adit --session 1 --session 3 -o without_tuesday.adit\n\n"
      "Exit codes: 0 written, 1 failed, 2 usage.");
  command.option("map", options->map, "The map, or the folder of its run")
      .required()
      .value_name("MAP|OUT");
  command.option("-s,--session", options->sessions, "Number of a session; may be given again")
      .required()
      .one_value_each()
      .value_name("N");
  command.option("-o,--output", options->output, "The map to write; must not be there yet")
      .required()
      .value_name("SPLIT.adit")
      .written();
  command.flag("--json", options->json, "Report as JSON");
  command.action(
      [options, done = std::move(done)] { done(split_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
