// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Who may talk to the server, by what a request says of itself.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace adit {

/// Why a request or a client is refused.
enum class ViewRefusal {
  malformed,       ///< no HTTP, or no message that the page would send
  too_large,       ///< header, body or message
  too_slow,        ///< sends or takes nothing
  too_many,        ///< clients, or requests of one client
  foreign_host,    ///< the server is called by a name that is not its own
  foreign_origin,  ///< another page's script
  wrong_token,
  unknown_path,
  not_offered,  ///< a Foxglove client asks for what is not there; it is told, and stays
};
inline constexpr int kViewRefusals = 9;
/// In plain words, for the count at the end.
std::string_view to_string(ViewRefusal refusal);

struct ViewAccess {
  std::string address = "127.0.0.1";  ///< that is listened on
  std::string token{};                ///< that links carry; empty: none is asked for
  std::string foxglove_token{};       ///< that links for Foxglove carry: it opens nothing else
};

/// The address is the machine's own, which no other machine reaches.
bool is_loopback(std::string_view address);

/// What a request says of itself; a header that is not there is empty.
struct ViewRequest {
  std::string_view host;
  std::string_view origin;
  std::string_view target;   ///< path and query
  bool is_foxglove = false;  ///< it asks for Foxglove's protocol
};

/// Nothing where the request is let in. A name in Host that is neither localhost nor the address
/// listened on is refused, since such a name could be made to lead here by whoever owns it; numeric
/// addresses cannot, and ports are not compared, so that tunnels work. An Origin, which browsers
/// send, must be the Host's; but programs that speak Foxglove's protocol are pages of others, and
/// let in where there is a token that they have.
std::optional<ViewRefusal> refusal_of(const ViewAccess& access, const ViewRequest& request);

/// "/socket" of "/socket?token=1".
std::string_view path_of(std::string_view target);

/// 32 hexadecimal digits that nobody can guess.
std::string make_token();

}  // namespace adit
