// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Packets of Ouster's sensors, after the firmware user manual: columns of ranges in the profiles of
// OusterProfile, and readings of the IMU.
#pragma once

#include <optional>
#include <vector>

#include "adit/tools/packets/ouster_sensor.hpp"
#include "adit/tools/packets/packet_capture.hpp"

namespace adit {

/// Also true for packets of which the end was not captured; what is there is read.
bool is_ouster_data(const Datagram& datagram, const OusterSensor& sensor);
bool is_ouster_imu(const Datagram& datagram);

/// The time of a data packet's first valid column by the sensor's clock; nothing without one.
std::optional<Nanoseconds> ouster_time(const Datagram& datagram, const OusterSensor& sensor);

/// Puts the packets of one sensor together to sweeps, one a frame of the sensor, in its lidar frame
/// (docs of the sensor: x towards the connector). Columns come in their order of measurement, in
/// each the beams from the uppermost down; those without return are (0, 0, 0). A second return
/// follows the first where it is another one. Times are the sensor's own.
class OusterSweeps {
 public:
  /// `sensor` must outlive it. Without `points`, sweeps are only told apart.
  explicit OusterSweeps(const OusterSensor& sensor, bool points = true);

  /// Takes a data packet; gives the sweep that is whole by then, if one is.
  std::vector<Sweep> take(const Datagram& datagram);
  /// What is left at the end.
  std::optional<Sweep> finish();

 private:
  void add_column(std::span<const std::byte> pixels, std::size_t column, Nanoseconds time);
  Point point_of(double range, double encoder, std::size_t beam) const;

  const OusterSensor* sensor_;
  OusterPixel pixel_;
  bool points_;
  std::optional<Sweep> sweep_;
  unsigned frame_ = 0;
};

/// The reading in an IMU packet: stamped by the gyroscope's clock, in rad/s and m/s², in the IMU's
/// own axes.
ImuSample ouster_imu(const Datagram& datagram);

}  // namespace adit
