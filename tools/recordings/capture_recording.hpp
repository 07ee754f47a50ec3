// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "adit/tools/recordings/packet_decoder.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// Opens a capture (pcap or pcapng) of the packets of one sensor: those of velodyne_packets.hpp,
/// hesai_packets.hpp, livox_packets.hpp and ouster_packets.hpp. `metadata` is Ouster's JSON (where
/// it is empty: that beside the capture), or Hesai's angle correction file. All packets are read
/// once to count the sweeps. Packets that were captured twice are used once, and those that arrived
/// in another order are read in that of the sensor's clock (PacketOrder).
///
/// Topics: /points; for Velodyne /fix, where a GNSS receiver is attached; for Ouster and Livox
/// /imu; for Ouster /tf_static (frames os_sensor, os_lidar, os_imu); /gpsd/fix where `adit live`
/// recorded a gpsd with them. Throws InputError: packets of no sensor that is known, of several, or
/// without the metadata that they need.
std::unique_ptr<Recording> open_packet_capture(const std::filesystem::path& path,
                                               const std::filesystem::path& metadata = {});

/// The sensor of such a capture, by its first packets. Throws as open_packet_capture() does.
PacketSensor sensor_of_capture(const std::filesystem::path& path,
                               const std::filesystem::path& metadata = {});

}  // namespace adit
