// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/clouds/cloud_columns.hpp"
#include "adit/tools/recordings/ros_messages.hpp"

namespace adit::ros {

/// The sweep in a point cloud, `stamp` being its header's time. Fields are known by their names, as
/// in cloud_columns.hpp; per-point times as in point_times.hpp. The stamp of the result is
/// absolute. Throws CodecError where the layout makes no sense, InputError (naming `file`) where a
/// point does.
CloudFile to_sweep(const PointCloud2& cloud, Nanoseconds stamp, const std::filesystem::path& file,
                   const CloudReading& reading = {});

/// The sweep in Livox's own message. Its timebase is the time of the first point; where it is 0 the
/// header's time is taken.
CloudFile to_sweep(const LivoxCustomMsg& message, Nanoseconds stamp);

/// The sweep in the packets of a Velodyne (velodyne_packets.hpp). Times of points are the sensor's,
/// counted from the first point; that was taken when the first packet is stamped, else at the
/// header's time. Throws CodecError where no packet is of a model that is read.
CloudFile to_sweep(const VelodyneScan& scan, Nanoseconds stamp);

/// A cloud with the bytes that its `data` views.
struct CloudMessage {
  std::vector<std::byte> data;
  PointCloud2 message;
};

/// Fields: x y z and, if asked for, intensity as float32, and where the sweep has them ring as
/// uint16 and time as float32, seconds after the header's stamp. Sweeps of more than a second have
/// t as uint32, nanoseconds, instead. Where it has radial speeds, doppler as float32, m/s.
CloudMessage to_cloud(const Sweep& sweep, const std::string& frame, bool with_intensity = true);

}  // namespace adit::ros
