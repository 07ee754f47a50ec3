// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/served_page.hpp"

#include <ostream>
#include <stdexcept>

#include <fmt/core.h>

#include "adit/tools/viewer/view_page.hpp"

namespace adit {
namespace {

constexpr double kMegabyte = 1e6;

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

}  // namespace

std::string_view required_page() {
  if (view_page().empty()) {
    throw std::runtime_error(
        "this build has no page, since npm or what it needs was missing when it was made. In a "
        "checkout `./dev setup` and `./dev build` make one; packages have it. OUT/map.html, which "
        "`adit run` leaves, needs no server.");
  }
  return view_page();
}

ViewAccess access_of(const ServeOptions& options) {
  const std::string address = options.listen == "localhost" ? "127.0.0.1" : options.listen;
  const bool asks = options.foxglove || !is_loopback(address);
  return {.address = address,
          .token = asks ? make_token() : "",
          .foxglove_token = asks ? make_token() : ""};
}

void say_link(const std::string& link, const ViewAccess& access, std::string_view may,
              std::ostream& out) {
  out << "open  " << link << "\n";
  if (access.address == "0.0.0.0" || access.address == "::") {
    out << "from other machines with this machine's numeric address in place of " << access.address
        << "\n";
  }
  if (!is_loopback(access.address)) {
    out << "Whoever has the link " << may << "; it is not encrypted on its way.\n";
  }
  out << std::flush;
}

void say_foxglove_link(const std::string& link, std::ostream& out) {
  out << "Foxglove or Lichtblick, as a Foxglove WebSocket:  " << link << std::endl;
}

void say_counts(const ViewCounts& counts, std::ostream& out) {
  out << fmt::format("{} connections, {} tiles, {:.1f} MB sent\n", counts.clients, counts.tiles,
                     static_cast<double>(counts.bytes_sent) / kMegabyte);
  if (counts.messages > 0) {
    out << fmt::format("{} messages to Foxglove's clients\n", counts.messages);
  }
  if (counts.refused() > 0) {
    out << fmt::format("refused {}: {}\n", counts.refused(), refusals_text(counts));
  }
  out << std::flush;
}

}  // namespace adit
