// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/source_list.hpp"

#include <array>
#include <exception>
#include <memory>
#include <optional>
#include <ostream>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/dds/dds_library.hpp"
#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/live/topic_choice.hpp"
#include "adit/tools/live/udp_receiver.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

struct SensorPort {
  uint16_t port;
  const char* sensors;
};

// Where sensors send to by default, after their manuals.
constexpr std::array kPorts = {SensorPort{2368, "Velodyne, Hesai"}, SensorPort{7502, "Ouster"},
                               SensorPort{56301, "Livox"}};

/// Packets are counted, and go nowhere.
class NoPackets final : public PacketSink {
 public:
  void add(const ReceivedDatagram&) override {}
  void commit() override {}
  void finish() override {}
};

struct ListenedPort {
  SensorPort port;
  std::unique_ptr<UdpReceiver> receiver;
};

std::vector<ListenedPort> listen(NoPackets& nowhere, std::ostream& out) {
  std::vector<ListenedPort> ports;
  for (const SensorPort& port : kPorts) {
    try {
      ports.push_back({.port = port,
                       .receiver = std::make_unique<UdpReceiver>(
                           std::vector<UdpEndpoint>{{.address = "0.0.0.0", .port = port.port}},
                           nowhere, std::nullopt)});
    } catch (const InputError&) {
      out << fmt::format("udp        port {} ({}): another program listens there\n", port.port,
                         port.sensors);
    }
  }
  return ports;
}

/// A line for each topic; returns the command that maps them, or nothing.
std::string say_topics(DdsNode& node, std::ostream& out) {
  std::string command;
  for (const PublishedTopic& one : understood_topics(node)) {
    const TopicKind kind = kind_of(one.topic);
    out << fmt::format("{:10} {}\n", to_string(kind), text_of(one.topic));
    if (kind == TopicKind::sweeps) {
      command = "adit live ros2 -o out";
    }
  }
  return command;
}

std::string say_packets(const ListenedPort& port, double wait_s, std::ostream& out) {
  const UdpCounts counts = port.receiver->counts().front();
  const uint64_t arrived = counts.datagrams + counts.unknown;
  if (arrived == 0) {
    return "";
  }
  out << fmt::format("udp        port {} ({}): {:.0f} packets/s{}\n", port.port.port,
                     port.port.sensors, static_cast<double>(arrived) / wait_s,
                     counts.sender.empty() ? "" : " from " + counts.sender);
  if (counts.datagrams > 0) {
    return fmt::format("adit live udp://0.0.0.0:{} -o out", port.port.port);
  }
  // An Ouster's packets are known by its metadata alone.
  return port.port.port == 7502
             ? "adit live udp://0.0.0.0:7502 udp://0.0.0.0:7503 --metadata SENSOR.json -o out"
             : "";
}

}  // namespace

int list_sources(double wait_s, std::ostream& out) {
  std::unique_ptr<DdsNode> node;
  try {
    node = open_dds_node(dds_options_of_environment());
  } catch (const std::exception& error) {
    out << "topics     " << error.what() << "\n";
  }
  NoPackets nowhere;
  const std::vector<ListenedPort> ports = listen(nowhere, out);
  const auto start = LiveClock::now();
  while (seconds_since(start) < wait_s && StopSignal::received() == 0) {
    std::this_thread::sleep_for(kLookEvery);
  }
  std::vector<std::string> commands;
  if (node) {
    commands.push_back(say_topics(*node, out));
  }
  for (const ListenedPort& port : ports) {
    commands.push_back(say_packets(port, seconds_since(start), out));
  }
  std::erase(commands, "");
  for (const std::string& command : commands) {
    out << "map it: " << command << "\n";
  }
  if (commands.empty()) {
    out << "no sweeps arrive, and no topic of point clouds is published\n";
  }
  out << std::flush;
  return commands.empty() ? 1 : 0;
}

}  // namespace adit
