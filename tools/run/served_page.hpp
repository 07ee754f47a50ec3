// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What commands that serve a page have in common: where it is served, and what is said of it.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>

#include "adit/tools/viewer/view_access.hpp"
#include "adit/tools/viewer/view_server.hpp"

namespace adit {

struct ServeOptions {
  std::string listen = "127.0.0.1";  ///< address; others than loopback ask for a token
  uint32_t port = 0;                 ///< 0: any that is free
  bool foxglove = false;             ///< a token is made and told, by which Foxglove's pages get in

  bool operator==(const ServeOptions&) const = default;
};

/// The page of this build. Throws std::runtime_error where it has none.
std::string_view required_page();

/// Who may see it: all of this machine, or whoever has the token. Pages of others, as Foxglove's
/// are, need one even on this machine.
ViewAccess access_of(const ServeOptions& options);

/// The link, and who else can open it. `may`: what those may do, "sees the map".
void say_link(const std::string& link, const ViewAccess& access, std::string_view may,
              std::ostream& out);

/// The link for Foxglove.
void say_foxglove_link(const std::string& link, std::ostream& out);

/// What has been sent, and who was refused.
void say_counts(const ViewCounts& counts, std::ostream& out);

}  // namespace adit
