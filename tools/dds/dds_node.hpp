// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A node among ROS 2 nodes, without ROS: topics and messages over DDS. The implementation is a
// plug-in that is opened at run time (dds_library.hpp), so that adit needs no DDS to start.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// A topic as ROS 2 names it, and what its publisher offers or its subscriber asks for.
struct DdsTopic {
  std::string name;       ///< "/points"
  std::string type;       ///< "sensor_msgs/PointCloud2"
  bool reliable = false;  ///< messages that are lost on the way are sent again
  bool latched = false;   ///< late subscribers get the last messages (transient local)
};

/// Where a node takes part.
struct DdsOptions {
  uint32_t domain = 0;                      ///< ROS_DOMAIN_ID
  bool this_machine = true;                 ///< no other machine is seen, and none sees this one
  std::size_t receive_buffer = 32U << 20U;  ///< bytes of the socket, as far as the kernel grants it
};

/// A message with its CDR bytes, the encapsulation header included.
struct DdsMessage {
  std::size_t topic = 0;    ///< as subscribe() numbered it
  Nanoseconds received{0};  ///< since 1970, by this machine's clock
  std::vector<std::byte> bytes;
};

/// How many messages of a subscription did not arrive, as far as DDS reports it.
struct DdsFaults {
  uint64_t lost = 0;          ///< messages that were sent and not received
  uint64_t incompatible = 0;  ///< publishers whose quality of service does not fit
};

class DdsNode {
 public:
  DdsNode() = default;
  virtual ~DdsNode() = default;
  DdsNode(const DdsNode&) = delete;
  DdsNode& operator=(const DdsNode&) = delete;

  /// What others publish at this moment, one entry a publisher.
  virtual std::vector<DdsTopic> published() = 0;
  /// Subscribes, and returns the topic's number, counted from 0. Throws std::runtime_error.
  virtual std::size_t subscribe(const DdsTopic& topic) = 0;
  /// The next message of any subscription, in the order of arrival; nothing where none comes within
  /// that time.
  virtual std::optional<DdsMessage> take(std::chrono::milliseconds longest_wait) = 0;
  virtual DdsFaults faults(std::size_t topic) = 0;
  /// Begins to publish, and returns the number for publish(). Throws std::runtime_error.
  virtual std::size_t advertise(const DdsTopic& topic) = 0;
  /// Sends CDR bytes with their encapsulation header.
  virtual void publish(std::size_t topic, std::span<const std::byte> bytes) = 0;
};

/// Of this interface; a plug-in of another one is not used.
inline constexpr int kDdsInterface = 1;

/// Names of the plug-in's two functions: `int()` gives its kDdsInterface, and
/// `DdsNode*(const DdsOptions&, std::string& error)` a node, or null and why there is none.
inline constexpr const char* kDdsInterfaceFunction = "adit_dds_interface";
inline constexpr const char* kDdsOpenFunction = "adit_dds_open";

}  // namespace adit
