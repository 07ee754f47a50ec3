// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The other side of `adit live ros2`: publishes the messages of a recording at their pace, and
// prints how many of each topic it sent, then how many it received of what adit publishes.
//
//   topic_peer RECORDING SPEED [SEED]
//
// With a seed every other message is damaged: cut off, with other bytes, or with counts that are
// far too large.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "adit/tools/dds/dds_library.hpp"
#include "adit/tools/recordings/message_files.hpp"

namespace adit {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kNoDamage = -1;  // instead of a seed
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

/// Something that no publisher sends.
std::vector<std::byte> damaged(std::span<const std::byte> message, std::mt19937& random) {
  std::vector<std::byte> bytes(message.begin(), message.end());
  const auto place = [&] { return random() % std::max<std::size_t>(bytes.size(), 1); };
  switch (random() % 4) {
    case 0:
      bytes.resize(place());
      break;
    case 1:
      for (int i = 0; i < 20 && !bytes.empty(); ++i) {
        bytes[place()] = static_cast<std::byte>(random());
      }
      break;
    case 2:  // among the header's strings and the counts of fields and points
      for (std::size_t i = 4 + random() % 200 / 4 * 4, k = 0; k < 4 && i + k < bytes.size(); ++k) {
        bytes[i + k] = std::byte{0xff};
      }
      break;
    default:
      bytes.resize(4 + random() % 1000, static_cast<std::byte>(random()));
  }
  bytes.resize(std::max<std::size_t>(bytes.size(), 4));  // the encapsulation's header
  return bytes;
}

int replay(const std::string& recording, double speed, int seed) {
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
  std::mt19937 random(static_cast<unsigned>(seed));
  const auto start = Clock::now();
  const auto messages = file.messages({});
  std::map<std::string, int> sent;
  std::optional<Nanoseconds> first;
  while (const auto message = messages->next()) {
    first = first.value_or(message->received);
    listener.listen_until(
        start + std::chrono::duration_cast<Clock::duration>((message->received - *first) / speed));
    if (seed != kNoDamage && random() % 2 == 0) {
      node->publish(topics[message->channel], damaged(message->bytes, random));
    } else {
      node->publish(topics[message->channel], message->bytes);
    }
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
  if (count != 3 && count != 4) {
    std::cerr << "usage: topic_peer RECORDING SPEED [SEED]\n";
    return 2;
  }
  try {
    return adit::replay(arguments[1], std::atof(arguments[2]),
                        count == 4 ? std::atoi(arguments[3]) : adit::kNoDamage);
  } catch (const std::exception& error) {
    std::cerr << "topic_peer: " << error.what() << "\n";
    return 1;
  }
}
