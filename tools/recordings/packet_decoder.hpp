// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "adit/tools/packets/gpsd_report.hpp"
#include "adit/tools/packets/hesai_packets.hpp"
#include "adit/tools/packets/livox_packets.hpp"
#include "adit/tools/packets/ouster_packets.hpp"
#include "adit/tools/packets/packet_order.hpp"
#include "adit/tools/packets/velodyne_packets.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// What packets come from.
struct PacketSensor {
  enum class Kind { velodyne, ouster, hesai, livox };

  std::string name;  ///< for people
  Kind kind = Kind::velodyne;
  std::optional<OusterSensor> ouster{};
  std::optional<HesaiAngles> hesai{};
  bool angles_of_design = false;  ///< its own were not given, and differ from those of the design
  bool gpsd = false;              ///< a gpsd was asked for its reports, which lie among the packets
};
PacketSensor ouster_packets_of(OusterSensor sensor);

/// Where a datagram belongs among those of the sensor; nothing for one that keeps its place: of
/// another kind, or without a time.
std::optional<PacketPlace> place_of(const Datagram& datagram, const PacketSensor& sensor);

/// What PacketOrder mended, for people; empty where nothing was.
std::vector<RecordingNotice> order_notices(const PacketOrderCounts& counts);

/// The topics of a sensor's events, in the order of PacketDecoder's, with no messages; then
/// /gpsd/fix where there is one.
std::vector<Topic> packet_topics(const PacketSensor& sensor);

/// From the datagrams of a sensor to events.
class PacketDecoder {
 public:
  static constexpr std::size_t kSweeps = 0;      ///< topics
  static constexpr std::size_t kSecond = 1;      ///< Velodyne: GNSS; Ouster, Livox: IMU
  static constexpr std::size_t kTransforms = 2;  ///< Ouster

  /// `sensor` must outlive it. Without `points`, sweeps are only told apart.
  PacketDecoder(const PacketSensor& sensor, bool points);

  /// Nothing as a rule: it takes many packets to make a sweep.
  std::vector<Event> take(const Datagram& datagram);
  /// What is left at the end.
  std::optional<Event> finish();

 private:
  std::optional<Event> other(const Datagram& datagram);
  Event event_of(Sweep sweep, Nanoseconds received);

  const PacketSensor* sensor_;
  std::variant<VelodyneSweeps, OusterSweeps, HesaiSweeps, LivoxSweeps> sweeps_;
  bool told_ = false;
  uint64_t bytes_ = 0;
  uint64_t count_ = 0;
  Nanoseconds last_{0};
  std::optional<Nanoseconds> last_fix_;
  std::size_t gpsd_topic_;  ///< the last, where there is one
  GpsdReports gpsd_;
};

/// How the parts of an Ouster are mounted to each other, as received at that time.
std::vector<Event> ouster_transforms(const OusterSensor& sensor, Nanoseconds received);

}  // namespace adit
