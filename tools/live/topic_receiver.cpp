// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/topic_receiver.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>

#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

constexpr auto kWait = std::chrono::milliseconds(20);

}  // namespace

TopicReceiver::TopicReceiver(DdsNode& node, const std::vector<DdsTopic>& topics, MessageSink& sink)
    : node_(node), sink_(sink), counts_(topics.size()) {
  for (const DdsTopic& topic : topics) {
    node_.subscribe(topic);
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
}

TopicReceiver::~TopicReceiver() {
  thread_.request_stop();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void TopicReceiver::receive(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested() && StopSignal::received() == 0) {
      take_what_is_there(kWait);
      sink_.commit();
    }
    take_what_is_there(std::chrono::milliseconds(0));
    sink_.finish();
  } catch (const std::exception& error) {
    {
      const std::scoped_lock lock(mutex_);
      failure_ = error.what();
    }
    sink_.abandon();
  }
}

void TopicReceiver::take_what_is_there(std::chrono::milliseconds longest_wait) {
  for (auto wait = longest_wait;; wait = std::chrono::milliseconds(0)) {
    const std::optional<DdsMessage> message = node_.take(wait);
    if (!message) {
      return;
    }
    sink_.write(message->topic, message->received, message->bytes);
    const std::scoped_lock lock(mutex_);
    TopicCounts& counts = counts_[message->topic];
    ++counts.messages;
    counts.bytes += message->bytes.size();
    counts.largest = std::max<uint64_t>(counts.largest, message->bytes.size());
  }
}

std::vector<TopicCounts> TopicReceiver::counts() const {
  const std::scoped_lock lock(mutex_);
  std::vector<TopicCounts> counts = counts_;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i].faults = node_.faults(i);
  }
  return counts;
}

std::string TopicReceiver::failure() const {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

}  // namespace adit
