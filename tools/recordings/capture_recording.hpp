// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// Opens a capture (pcap or pcapng) of the packets of Velodyne's VLP-16 or HDL-32E, or of an Ouster
/// sensor whose metadata lie beside it as JSON. All packets are read once to count the sweeps.
///
/// Topics: /points; for Velodyne /fix, where a GNSS receiver is attached; for Ouster /imu and
/// /tf_static (frames os_sensor, os_lidar, os_imu). Throws InputError: packets of no sensor that is
/// known, of several, or of an Ouster without its metadata.
std::unique_ptr<Recording> open_packet_capture(const std::filesystem::path& path);

}  // namespace adit
