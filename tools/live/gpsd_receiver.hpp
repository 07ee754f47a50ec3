// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "adit/tools/live/message_recorder.hpp"
#include "adit/tools/live/packet_recorder.hpp"
#include "adit/tools/packets/gpsd_report.hpp"

namespace adit {

/// Where gpsd listens.
struct GpsdEndpoint {
  std::string host;
  std::string port;
};

/// "gpsd://localhost:2947" as an endpoint, also without the port; nothing where the text does not
/// begin with gpsd://. Throws UsageError where there is no host.
std::optional<GpsdEndpoint> gpsd_endpoint(const std::string& source);

/// The gpsd among the sources; nothing where there is none. Throws UsageError for several.
std::optional<GpsdEndpoint> gpsd_among(const std::vector<std::string>& sources);

/// Its channel in a recording, of NavSatFix messages on /gpsd/fix.
Channel gpsd_channel();

/// Where reports of a gpsd go, a line each; returns whether it completes a fix. May throw
/// OutputError.
using GpsdSink = std::function<bool(std::string_view line, Nanoseconds received)>;

/// Writes fixes as NavSatFix messages to that channel of the sink, which outlives it.
GpsdSink fixes_to_messages(MessageSink& sink, std::size_t channel);

/// Says in a recording of packets that a gpsd is asked for its reports.
void begin_gpsd(PacketSink& sink);

/// Writes the reports of fixes as datagrams to the sink, which outlives it.
GpsdSink fixes_to_packets(PacketSink& sink);

/// Receives what a gpsd reports, in a thread of its own that connects again where the connection
/// ends. It ends at a signal (StopSignal) or with its life.
class GpsdReceiver {
 public:
  GpsdReceiver(GpsdEndpoint endpoint, GpsdSink sink);
  ~GpsdReceiver();
  GpsdReceiver(const GpsdReceiver&) = delete;
  GpsdReceiver& operator=(const GpsdReceiver&) = delete;

  uint64_t fixes() const { return fixes_; }
  uint64_t bytes() const { return bytes_; }  ///< of all reports
  bool connected() const { return connected_; }
  /// "gpsd://HOST:PORT: connected, 3 fixes", for people.
  std::string text() const;

 private:
  void receive(const std::stop_token& stop);
  void read_from(int descriptor, const std::stop_token& stop);

  GpsdEndpoint endpoint_;
  GpsdSink sink_;
  std::atomic<uint64_t> fixes_ = 0;
  std::atomic<uint64_t> bytes_ = 0;
  std::atomic<bool> connected_ = false;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace adit
