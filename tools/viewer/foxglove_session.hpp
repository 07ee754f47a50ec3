// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Foxglove's WebSocket protocol, the server's side: what one client is told, and what it may say
// (github.com/foxglove/ws-protocol, docs/spec.md). Newer programs call the same protocol
// foxglove.sdk.v1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/viewer/foxglove_feed.hpp"
#include "adit/tools/viewer/view_session.hpp"

namespace adit {

/// The first of the names in a Sec-WebSocket-Protocol header that is the protocol's; empty: none.
std::string_view foxglove_protocol_of(std::string_view offered);

/// A client of Foxglove's protocol. Of what a feed keeps for a while only, a slow one gets less.
class FoxgloveSession final : public ViewSession {
 public:
  /// Gives the feed of the moment. Where it is another one, channels are announced anew and what is
  /// subscribed to comes from its beginning. May throw InputError.
  using Source = std::function<std::shared_ptr<FoxgloveFeed>()>;

  /// `run`: a name that no other run of this program has.
  FoxgloveSession(Source source, const std::string& run);

  ViewTaken take(std::string_view message, bool is_text) override;
  std::optional<ViewFrame> next() override;
  std::optional<ViewRefusal> tell(const ViewText& /*text*/) override { return std::nullopt; }

 private:
  /// A channel that was announced. Its number is its place, and is never given to another topic.
  struct Announced {
    std::string topic;
    std::optional<std::size_t> channel{};  ///< of the feed; none: it has no such topic
    std::optional<uint32_t> subscription{};
    uint64_t told = 0;  ///< position
  };

  void follow_source();
  void announce(const std::shared_ptr<FoxgloveFeed>& feed);
  std::optional<ViewFrame> next_data();
  ViewTaken subscribe(uint32_t id, uint64_t number);
  ViewTaken unsubscribe(uint32_t id);
  ViewTaken complain(const std::string& text);
  void fail(const std::string& text);

  Source source_;
  std::shared_ptr<FoxgloveFeed> feed_;
  std::vector<Announced> announced_;
  std::deque<std::string> texts_;  ///< that wait to be sent
  /// Subscriptions that ended since their channel went: a client may end them, too.
  std::set<uint32_t> ended_;
  bool failed_ = false;  ///< the source or its feed: there are no more messages
};

}  // namespace adit
