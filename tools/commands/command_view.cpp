// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_view.hpp"

#include <iostream>
#include <memory>
#include <stdexcept>

#include <fmt/core.h>

#include "adit/tools/commands/command_guard.hpp"
#include "adit/tools/commands/command_line.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/viewer/view_data.hpp"
#include "adit/tools/viewer/view_page.hpp"
#include "adit/tools/viewer/view_protocol.hpp"
#include "adit/tools/viewer/view_server.hpp"

namespace adit {
namespace {

constexpr double kMegabyte = 1e6;
constexpr double kLastPort = 65535;

std::string refusals_text(const ViewCounts& counts) {
  std::string text;
  for (int i = 0; i < kViewRefusals; ++i) {
    const uint64_t count = counts.refusals[static_cast<std::size_t>(i)];
    if (count > 0) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count,
                          to_string(static_cast<ViewRefusal>(i)));
    }
  }
  return text;
}

void say_what_is_shown(const ViewData& data, const ViewServer& server, const ViewAccess& access,
                       std::ostream& out) {
  out << fmt::format("{}: {} points, {} keyframes\n", data.title(), data.points(),
                     data.keyframes());
  out << "open  " << server.link() << "\n";
  if (access.address == "0.0.0.0" || access.address == "::") {
    out << "from other machines with this machine's numeric address in place of " << access.address
        << "\n";
  }
  if (!is_loopback(access.address)) {
    out << "Whoever has the link sees the map" << (data.editable() ? " and may edit it" : "")
        << "; it is not encrypted on its way.\n";
  }
  out << "Ctrl-C ends it." << std::endl;
}

int run(const ViewCommandOptions& options, std::ostream& out, std::ostream& err) {
  if (view_page().empty()) {
    throw std::runtime_error(
        "this build has no page, since npm or what it needs was missing when it was made. In a "
        "checkout `./dev setup` and `./dev build` make one; packages have it. OUT/map.html, which "
        "`adit run` leaves, needs no server.");
  }
  const StopSignal stop;
  ViewData data({.what = options.what,
                 .edit = options.edit,
                 .stop = [] { return StopSignal::received() != 0; }},
                err);
  const ViewAccess access{.address = options.listen,
                          .token = is_loopback(options.listen) ? "" : make_token()};
  ViewServer server({.page = view_page(),
                     .greeting =
                         [&] {
                           return std::vector{data.scene(), data.graph()};
                         },
                     .answer = [&](std::string_view message) { return answer_to(data, message); },
                     .tile = [&](uint32_t number) { return data.tile(number); }},
                    access, static_cast<uint16_t>(options.port));
  say_what_is_shown(data, server, access, out);
  const ViewCounts counts = server.run([] { return StopSignal::received() != 0; });
  out << fmt::format("{} connections, {} tiles, {:.1f} MB sent\n", counts.clients, counts.tiles,
                     static_cast<double>(counts.bytes_sent) / kMegabyte);
  if (counts.refused() > 0) {
    out << fmt::format("refused {}: {}\n", counts.refused(), refusals_text(counts));
  }
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
      "  adit view out --listen 0.0.0.0\n\n"
      "Exit codes: 0 ended by Ctrl-C or SIGTERM, 1 nothing that can be shown, 2 usage,\n129, 130 "
      "or "
      "143 stopped by SIGHUP, SIGINT or SIGTERM before there was something to show.");
  command.option("what", options->what, "What to show").required().value_name("WHAT");
  command.option("--port", options->port, "Port; 0 takes any that is free")
      .value_name("N")
      .from(0, kLastPort)
      .show_default();
  command.option("--listen", options->listen, "Numeric address to listen on")
      .value_name("ADDRESS")
      .show_default();
  command.flag("--edit", options->edit, "Loops may be revoked and restored in the page");
  command.action(
      [options, done = std::move(done)] { done(view_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
