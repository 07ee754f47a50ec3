// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The other side of `adit live ros2`: publishes the messages of a recording at their pace, and
// prints how many of each topic it sent, then how many it received of what adit publishes.
//
//   topic_peer RECORDING SPEED
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "adit/tools/dds/dds_library.hpp"
#include "adit/tools/recordings/message_files.hpp"

namespace adit {
namespace {

using Clock = std::chrono::steady_clock;

// Time in which the other side finds the topics, and in which the last messages arrive.
constexpr auto kDiscovery = std::chrono::seconds(4);

/// Subscribes to what adit publishes, and counts.
class Listener {
 public:
  explicit Listener(DdsNode& node) : node_(node) {}

  void listen(std::chrono::milliseconds wait) {
    for (const DdsTopic& topic : node_.published()) {
      if (known_.insert(topic.name).second) {
        names_[node_.subscribe(topic)] = topic.name;
      }
    }
    while (const auto message = node_.take(wait)) {
      ++counts_[names_.at(message->topic)];
      wait = std::chrono::milliseconds(0);
    }
  }

  void listen_until(Clock::time_point end) {
    do {
      listen(std::chrono::milliseconds(5));
    } while (Clock::now() < end);
  }

  const std::map<std::string, int>& counts() const { return counts_; }

 private:
  DdsNode& node_;
  std::set<std::string> known_;
  std::map<std::size_t, std::string> names_;
  std::map<std::string, int> counts_;
};

int replay(const std::string& recording, double speed) {
  const auto files = open_message_files(recording);
  const MessageFile& file = *files.front();
  const std::unique_ptr<DdsNode> node = open_dds_node(dds_options_of_environment());
  std::vector<std::size_t> topics;
  for (const Channel& channel : file.channels()) {
    topics.push_back(node->advertise({.name = channel.topic,
                                      .type = channel.type,
                                      .reliable = true,
                                      .latched = channel.topic == "/tf_static"}));
  }
  Listener listener(*node);
  std::cout << "ready" << std::endl;
  listener.listen_until(Clock::now() + kDiscovery);
  const auto start = Clock::now();
  const auto messages = file.messages({});
  std::map<std::string, int> sent;
  std::optional<Nanoseconds> first;
  while (const auto message = messages->next()) {
    first = first.value_or(message->received);
    listener.listen_until(
        start + std::chrono::duration_cast<Clock::duration>((message->received - *first) / speed));
    node->publish(topics[message->channel], message->bytes);
    ++sent[file.channels()[message->channel].topic];
  }
  listener.listen_until(Clock::now() + kDiscovery);
  for (const auto& [topic, count] : sent) {
    std::cout << "sent " << topic << " " << count << "\n";
  }
  for (const auto& [topic, count] : listener.counts()) {
    std::cout << "received " << topic << " " << count << "\n";
  }
  return 0;
}

}  // namespace
}  // namespace adit

int main(int count, char** arguments) {
  if (count != 3) {
    std::cerr << "usage: topic_peer RECORDING SPEED\n";
    return 2;
  }
  try {
    return adit::replay(arguments[1], std::atof(arguments[2]));
  } catch (const std::exception& error) {
    std::cerr << "topic_peer: " << error.what() << "\n";
    return 1;
  }
}
