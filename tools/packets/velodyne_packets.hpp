// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Packets of Velodyne's VLP-16, Puck Hi-Res, HDL-32E, VLP-32C and VLS-128 (Alpha Prime), after
// their manuals: twelve blocks of 32 ranges each, single or dual returns, with the microsecond of
// the hour; and position packets that repeat the GNSS receiver's $GPRMC sentence.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adit/tools/packets/packet_capture.hpp"

namespace adit {

struct VelodyneModel;

bool is_velodyne_data(const Datagram& datagram);
bool is_velodyne_position(const Datagram& datagram);

/// The model's name; nothing for one that is not read.
std::optional<std::string> velodyne_model(const Datagram& data);

/// The time of a data packet by the sensor's clock, in the hour in which it was captured.
Nanoseconds velodyne_time(const Datagram& data);

/// Puts the packets of one sensor together to sweeps: from one passage through azimuth 0 to the
/// next, points in the order in which they were measured, x ahead (azimuth 0), y left, z up.
///
/// Times are the sensor's own, of the hour in which they were captured. Of two returns that are the
/// same one is kept; directions without return are left out.
class VelodyneSweeps {
 public:
  /// Without `points`, sweeps are only told apart: they have a stamp and nothing else.
  explicit VelodyneSweeps(bool points = true) : points_(points) {}

  /// Takes a data packet; gives the sweeps that are whole by then, as a rule none or one.
  std::vector<Sweep> take(const Datagram& datagram);
  /// What is left at the end.
  std::optional<Sweep> finish();

 private:
  void follow_rotation(std::span<const std::byte> data, std::size_t block,
                       const VelodyneModel& model, Nanoseconds time);
  void add_block(std::span<const std::byte> data, std::size_t block, const VelodyneModel& model,
                 double since_stamp);
  bool begins_anew(double azimuth, Nanoseconds time) const;

  bool points_;
  std::optional<Sweep> sweep_;
  double last_azimuth_ = 0.0;               ///< degrees
  std::optional<Nanoseconds> last_time_{};  ///< of the block before
  double advance_ =
      0.2;  ///< degrees from a firing sequence to the next, of the last that made sense
};

/// The fix in a position packet: WGS 84, no covariance, altitude 0 (the sentence has none). Nothing
/// where the receiver had no fix or the sentence is damaged.
std::optional<GnssFix> velodyne_fix(const Datagram& position);

}  // namespace adit
