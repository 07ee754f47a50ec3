// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Packets of an Ouster in messages (PacketMsg), as its ROS drivers record them.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/recordings/ordered_packets.hpp"

namespace adit {

/// True for a channel of such packets, whatever sensor's.
bool is_packet_channel(const Channel& channel);

/// True for a recording that has such packets in messages, or is a capture of a sensor's packets.
/// Throws InputError where it cannot be opened.
bool holds_packets(const std::filesystem::path& recording);

/// True where those are readings of the IMU, by the topic's name.
bool is_imu_packet_channel(const Channel& channel);

/// The sensor whose packets the files hold. Its metadata is the file `metadata`; else, where that
/// is empty, what a topic ".../metadata" holds (std_msgs/String), or the JSON beside `recording`.
/// Nothing where there are no packets, or no metadata. Throws InputError where they make no sense.
std::optional<PacketSensor> packet_sensor_of(const std::vector<std::unique_ptr<MessageFile>>& files,
                                             const std::filesystem::path& recording,
                                             const std::filesystem::path& metadata);

/// The datagram in a message; empty where it is no whole PacketMsg.
std::optional<Datagram> datagram_of(const Channel& channel, const RawMessage& message);

/// How many sweeps are complete with the packets of a file; `packets` continues from file to file.
uint64_t count_sweeps(const MessageFile& file, OrderedPackets& packets);

/// The sweeps among events of a PacketDecoder.
uint64_t count_sweeps(const std::vector<Event>& events);

}  // namespace adit
