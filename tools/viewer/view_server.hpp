// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// HTTP and WebSocket on one port, for the page and for Foxglove's protocol. Boost is seen by
// view_server.cpp, and by the server of a live run's status.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/viewer/foxglove_session.hpp"
#include "adit/tools/viewer/view_access.hpp"
#include "adit/tools/viewer/view_session.hpp"

namespace adit {

/// What clients can take of the server. Its memory is bounded by `clients` times a tile and the
/// news of one moment, the texts that are common to all, and 16 KiB a client.
struct ViewLimits {
  std::size_t clients = 32;            ///< connections at a time; others are sent away
  std::size_t header_bytes = 8192;     ///< of a request
  std::size_t message_bytes = 16'384;  ///< of a WebSocket message
  std::size_t waiting = 512;           ///< tiles and texts that a client waits for
  std::chrono::seconds request{10};    ///< for a request to come and its answer to go
  std::chrono::seconds silence{20};    ///< of a WebSocket client: it answers no ping
};

/// The answer to a client's message.
struct ViewAnswer {
  std::vector<uint32_t> tiles{};  ///< to be sent to that client, as they are asked for
  std::string reply{};            ///< text for that client; empty: none
  std::string to_all{};           ///< text for all clients, that one too; empty: none
  bool understood = true;         ///< false: no message that the page sends
};

/// What has changed since a client was told last.
struct ViewNews {
  std::vector<ViewText> texts{};
  uint64_t told = 0;  ///< up to which that client knows it then
};

/// What is served. What a function throws ends run().
struct ViewSite {
  std::string_view page;  ///< HTML, packed with gzip; must outlive the server
  std::function<std::vector<std::string>()> greeting;  ///< texts that a client begins with
  std::function<ViewAnswer(std::string_view)> answer;  ///< to a client's text
  std::function<std::string(uint32_t)> tile;           ///< bytes; empty: no such tile
  /// Asked ten times a second for each client that waits for nothing, with what it was told up to
  /// (0: nothing): one that is slow is told less often, and then all at once. Empty: nothing
  /// changes.
  std::function<ViewNews(uint64_t)> news{};
  /// What Foxglove and its like get, asked before each message. Empty: they are not served.
  FoxgloveSession::Source foxglove{};
};

/// What has come and gone, in all.
struct ViewCounts {
  uint64_t clients = 0;     ///< WebSocket connections let in
  uint64_t tiles = 0;       ///< sent
  uint64_t messages = 0;    ///< of channels, sent to Foxglove's clients
  uint64_t bytes_sent = 0;  ///< of tiles, texts and messages
  std::array<uint64_t, kViewRefusals> refusals{};

  uint64_t refused() const;
};

class ViewServer {
 public:
  /// Listens. `port` 0: any that is free. Throws UsageError where that cannot be listened on.
  ViewServer(ViewSite site, const ViewAccess& access, uint16_t port, const ViewLimits& limits = {});
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  uint16_t port() const;
  /// What to open in a browser, with the token where there is one.
  std::string link() const;
  /// What to open in Foxglove or Lichtblick, likewise.
  std::string foxglove_link() const;

  /// Serves on this thread until `stop` says so, which is asked ten times a second.
  ViewCounts run(const std::function<bool()>& stop);

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
};

}  // namespace adit
