// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "adit/tools/live/message_recorder.hpp"

namespace adit {

/// Where gpsd listens.
struct GpsdEndpoint {
  std::string host;
  std::string port;
};

/// "gpsd://localhost:2947" as an endpoint, also without the port; nothing where the text does not
/// begin with gpsd://. Throws UsageError where there is no host.
std::optional<GpsdEndpoint> gpsd_endpoint(const std::string& source);

/// The gpsd among the sources; nothing where there is none.
std::optional<GpsdEndpoint> gpsd_among(const std::vector<std::string>& sources);

/// Its channel in a recording, of NavSatFix messages on /gpsd/fix.
Channel gpsd_channel();

/// Records the fixes of a gpsd as NavSatFix messages, in a thread of its own that connects again
/// where the connection ends. It ends at a signal (StopSignal) or with its life.
class GpsdReceiver {
 public:
  /// Writes to that channel of the sink, which outlives it.
  GpsdReceiver(GpsdEndpoint endpoint, MessageSink& sink, std::size_t channel);
  ~GpsdReceiver();
  GpsdReceiver(const GpsdReceiver&) = delete;
  GpsdReceiver& operator=(const GpsdReceiver&) = delete;

  uint64_t fixes() const { return fixes_; }
  bool connected() const { return connected_; }

 private:
  void receive(const std::stop_token& stop);
  void read_from(int descriptor, const std::stop_token& stop);

  GpsdEndpoint endpoint_;
  MessageSink& sink_;
  std::size_t channel_;
  std::atomic<uint64_t> fixes_ = 0;
  std::atomic<bool> connected_ = false;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace adit
