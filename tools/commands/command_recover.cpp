// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_recover.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/map_database/map_recovery.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr std::size_t kTold = 10;

void tell(const std::vector<std::string>& texts, const char* head, std::ostream& out) {
  for (std::size_t i = 0; i < std::min(texts.size(), kTold); ++i) {
    out << head << texts[i] << "\n";
  }
  if (texts.size() > kTold) {
    out << head << "and " << texts.size() - kTold << " more\n";
  }
}

/// What is lost, in numbers.
std::string lost_of(const MapRecovery& done) {
  if (done.problems.empty()) {
    return "nothing";
  }
  std::string text;
  const auto add = [&](std::size_t count, const std::string& what) {
    if (count > 0) {
      text += (text.empty() ? "" : ", ") + fmt::format("{} {}", count, what);
    }
  };
  add(done.lost_keyframes.size(), "keyframes");
  add(done.without_points.size(), "keyframes' points");
  add(done.lost_edges, "edges");
  add(done.lost_candidates, "candidates");
  add(done.lost_fixes, "fixes");
  add(done.lost_control, "control points");
  add(done.lost_headings, "headings");
  if (text.empty()) {
    return done.may_lack_more ? "nothing that can be counted; see above" : "see above";
  }
  return (done.may_lack_more ? "at least " : "") + text;
}

int run(const RecoverCommandOptions& options, std::ostream& out) {
  std::error_code ignored;
  if (std::filesystem::exists(options.output, ignored)) {
    throw UsageError("-o " + options.output.string() +
                     ": there is a file of that name. Name one that is not there yet.");
  }
  const std::filesystem::path map = find_map(options.map);
  const MapRecovery done = recover_map(map, options.output);
  tell(done.damaged_pages, "damaged    ", out);
  tell(done.problems, "lost       ", out);
  out << fmt::format("recovered  {} keyframes, {} edges, {} candidates, {} fixes, {} sessions\n",
                     done.keyframes, done.edges, done.candidates, done.fixes, done.sessions);
  out << "lost       " << lost_of(done) << "\n";
  if (done.parts > 1) {
    out << fmt::format(
        "parts      {}, without an edge between them: how they lie to each other is a guess\n",
        done.parts);
  }
  out << "wrote      " << options.output.string() << "; " << map.string() << " stays as it is\n";
  return done.problems.empty() ? 0 : 1;
}

}  // namespace

int recover_command(const RecoverCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit recover", out, err, [&] { return run(options, out); });
}

void add_recover_command(Command app, std::function<void(int)> done) {
  const Command command =
      app.add_command("recover", "Write what is whole of a damaged map into a new one");
  const auto options = std::make_shared<RecoverCommandOptions>();
  command.footer(
      "For a map of which `adit check` says that it is damaged.\n\n"
      "OUT is the folder of a run, MAP the map in it, OUT/map.adit.\n\n"
      "Example:\n"
      "  adit recover out -o recovered.adit\n\n"
      "Exit codes: 0 nothing was lost, 1 something is lost or nothing can be read, 2 usage.");
  command.option("map", options->map, "The map, or the folder of its run")
      .required()
      .value_name("MAP|OUT");
  command.option("-o,--output", options->output, "The map to write; must not be there yet")
      .required()
      .value_name("NEW")
      .written();
  command.action(
      [options, done = std::move(done)] { done(recover_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
