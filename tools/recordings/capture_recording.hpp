// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// Opens a capture (pcap or pcapng) of the packets of Velodyne's VLP-16 or HDL-32E, of Hesai's XT,
/// OT128, Pandar128 or Pandar64, of Livox's Mid-360 or HAP, or of an Ouster sensor. `metadata` is
/// Ouster's JSON (where it is empty: that beside the capture), or Hesai's angle correction file.
/// All packets are read once to count the sweeps.
///
/// Topics: /points; for Velodyne /fix, where a GNSS receiver is attached; for Ouster and Livox
/// /imu; for Ouster /tf_static (frames os_sensor, os_lidar, os_imu). Throws InputError: packets of
/// no sensor that is known, of several, or without the metadata that they need.
std::unique_ptr<Recording> open_packet_capture(const std::filesystem::path& path,
                                               const std::filesystem::path& metadata = {});

}  // namespace adit
