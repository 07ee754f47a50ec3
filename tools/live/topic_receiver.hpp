// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "adit/tools/dds/dds_node.hpp"
#include "adit/tools/live/message_recorder.hpp"

namespace adit {

/// What arrived of a topic.
struct TopicCounts {
  uint64_t messages = 0;
  uint64_t bytes = 0;
  uint64_t largest = 0;  ///< bytes of a message
  DdsFaults faults{};
};

/// Records the messages of topics as they arrive, in a thread of its own. It ends at a signal
/// (StopSignal), by stop() or with its life.
class TopicReceiver {
 public:
  /// Subscribes to the topics, which are the sink's channels in their order. Both outlive it.
  TopicReceiver(DdsNode& node, const std::vector<DdsTopic>& topics, MessageSink& sink);
  ~TopicReceiver();
  TopicReceiver(const TopicReceiver&) = delete;
  TopicReceiver& operator=(const TopicReceiver&) = delete;

  /// By topic.
  std::vector<TopicCounts> counts() const;
  /// Why receiving ended early; empty: it did not.
  std::string failure() const;
  /// Ends receiving; what has arrived by now is recorded.
  void stop() { thread_.request_stop(); }
  /// Until it has ended.
  void wait() { thread_.join(); }

 private:
  void receive(const std::stop_token& stop);
  void take_what_is_there(std::chrono::milliseconds longest_wait);

  DdsNode& node_;
  MessageSink& sink_;
  mutable std::mutex mutex_;  ///< of the counts and the failure
  std::vector<TopicCounts> counts_;
  std::string failure_;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace adit
