// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "adit/tools/live/packet_recorder.hpp"
#include "adit/tools/packets/ouster_sensor.hpp"

namespace adit {

/// An IPv4 address and a port of this machine.
struct UdpEndpoint {
  std::string address;
  uint16_t port = 0;
};

/// "udp://127.0.0.1:2368" as an endpoint; nothing where the text does not begin with udp://. Throws
/// UsageError where the rest is no address and port.
std::optional<UdpEndpoint> udp_endpoint(const std::string& source);
std::string text_of(const UdpEndpoint& endpoint);

/// What arrived at an endpoint.
struct UdpCounts {
  uint64_t datagrams = 0;  ///< that a sensor sent
  uint64_t bytes = 0;
  uint64_t unknown = 0;        ///< of no known sensor: neither used nor recorded
  uint64_t other_senders = 0;  ///< from another address than the first: neither used nor recorded
  uint64_t lost = 0;           ///< the kernel's buffer was full
  std::string sender{};        ///< address of the sensor; empty: nothing has arrived
  uint64_t buffer = 0;         ///< bytes that the kernel granted
};

/// Receives the datagrams of sensors at some endpoints, in a thread of its own, and records those
/// that are packets of a known sensor. It ends at a signal (StopSignal) or with its life.
class UdpReceiver {
 public:
  /// Listens from now on. `ouster` describes the packets of an Ouster, if there is one. Throws
  /// InputError where an endpoint cannot be listened at. `sink` outlives it.
  UdpReceiver(const std::vector<UdpEndpoint>& endpoints, PacketSink& sink,
              std::optional<OusterSensor> ouster);
  ~UdpReceiver();
  UdpReceiver(const UdpReceiver&) = delete;
  UdpReceiver& operator=(const UdpReceiver&) = delete;

  /// Of each endpoint, in their order.
  std::vector<UdpCounts> counts() const;
  /// Why receiving ended early; empty: it did not.
  std::string failure() const;
  /// Ends receiving; what has arrived by now is recorded.
  void stop() { thread_.request_stop(); }
  /// Until it has ended.
  void wait() { thread_.join(); }

 private:
  struct Socket {
    int descriptor = -1;
    UdpEndpoint endpoint;
    uint32_t address = 0;  ///< host byte order
    UdpCounts counts{};
    std::optional<uint32_t> first_sender{};
  };

  void open(const UdpEndpoint& endpoint);
  void receive(const std::stop_token& stop);
  void drain(Socket& socket);
  void take(Socket& socket, const ReceivedDatagram& datagram);
  bool is_known(const ReceivedDatagram& datagram) const;

  PacketSink& sink_;
  std::optional<OusterSensor> ouster_;
  std::vector<std::byte> buffer_;
  mutable std::mutex mutex_;  ///< of the counts and the failure
  std::vector<Socket> sockets_;
  std::string failure_;
  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace adit
