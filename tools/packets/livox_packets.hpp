// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Packets of Livox's Mid-360 and HAP, after their communication protocol (Livox SDK 2): Cartesian
// points in mm or cm, and readings of the IMU.
#pragma once

#include <optional>
#include <vector>

#include "adit/tools/packets/packet_capture.hpp"

namespace adit {

/// Also true for packets of which the end was not captured; what is there is read.
bool is_livox_data(const Datagram& datagram);
bool is_livox_imu(const Datagram& datagram);

/// The time of a packet of either kind by the sensor's clock.
Nanoseconds livox_time(const Datagram& datagram);

/// Puts the packets of one sensor together to sweeps of a tenth of a second, since its pattern has
/// no turns. Points are in the sensor's own frame, in their order of measurement, without those
/// that it marks as noise (bits 4 and 5 of the tag) and without directions that had no return.
/// Times are the sensor's own.
class LivoxSweeps {
 public:
  /// Without `points`, sweeps are only told apart.
  explicit LivoxSweeps(bool points = true) : points_(points) {}

  /// Takes a data packet; gives the sweep that is whole by then, if one is.
  std::vector<Sweep> take(const Datagram& datagram);
  /// What is left at the end.
  std::optional<Sweep> finish();

 private:
  bool points_;
  std::optional<Sweep> sweep_;
};

/// The reading in an IMU packet, in rad/s and m/s².
ImuSample livox_imu(const Datagram& datagram);

}  // namespace adit
