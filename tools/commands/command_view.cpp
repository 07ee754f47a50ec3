// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_view.hpp"

#include <iostream>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/commands/command_guard.hpp"
#include "adit/tools/commands/command_line.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/viewer/view_data.hpp"
#include "adit/tools/viewer/view_protocol.hpp"
#include "adit/tools/viewer/view_server.hpp"

namespace adit {
namespace {

int run(const ViewCommandOptions& options, std::ostream& out, std::ostream& err) {
  const std::string_view page = required_page();
  const StopSignal stop;
  ViewData data({.what = options.what,
                 .edit = options.edit,
                 .stop = [] { return StopSignal::received() != 0; }},
                err);
  const ViewAccess access = access_of(options.serve);
  ViewServer server({.page = page,
                     .greeting =
                         [&] {
                           return std::vector{data.scene(), data.graph()};
                         },
                     .answer = [&](std::string_view message) { return answer_to(data, message); },
                     .tile = [&](uint32_t number) { return data.tile(number); },
                     .foxglove = [&] { return data.foxglove(); }},
                    access, static_cast<uint16_t>(options.serve.port));
  out << fmt::format("{}: {} points, {} keyframes\n", data.title(), data.points(),
                     data.keyframes());
  say_link(server.link(), access, data.editable() ? "sees the map and may edit it" : "sees the map",
           out);
  if (options.serve.foxglove) {
    say_foxglove_link(server.foxglove_link(), out);
  }
  out << "Ctrl-C ends it." << std::endl;
  say_counts(server.run([] { return StopSignal::received() != 0; }), out);
  return 0;
}

}  // namespace

int view_command(const ViewCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit view", out, err, [&] {
    try {
      return run(options, out, err);
    } catch (const ViewStopped&) {
      return 128 + StopSignal::received();
    }
  });
}

void add_view_command(Command app, std::function<void(int)> done) {
  const Command command =
      app.add_command("view", "Show a map, a run or a cloud in a browser, and edit its loops");
  const auto options = std::make_shared<ViewCommandOptions>();
  command.footer(
      "WHAT is a map (OUT/map.adit), the folder OUT of a run, or a cloud (PLY, PCD or LAS).\n"
      "The page needs no network beyond this program. It is served to this machine alone, unless "
      "--listen names another address; the printed link then carries a token.\n\n"
      "Examples:\n"
      "  adit view out\n"
      "  adit view out/map.adit --edit\n"
      "  adit view scan.ply --port 8080\n"
      "  adit view out --listen 0.0.0.0\n"
      "  adit view out --foxglove\n\n"
      "Exit codes: 0 ended by Ctrl-C or SIGTERM, 1 nothing that can be shown, 2 usage,\n129, 130 "
      "or "
      "143 stopped by SIGHUP, SIGINT or SIGTERM before there was something to show.");
  command.option("what", options->what, "What to show").required().value_name("WHAT");
  add_serve_options(command, options->serve);
  command.flag("--edit", options->edit, "Loops may be revoked and restored in the page");
  command.action(
      [options, done = std::move(done)] { done(view_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
