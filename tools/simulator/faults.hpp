// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What goes wrong with recordings outside, by name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/simulator/camera_simulator.hpp"
#include "adit/tools/simulator/range_simulator.hpp"

namespace adit {

enum class Fault {
  clock_offset,      ///< the IMU's stamps are 50 ms late
  clock_drift,       ///< the IMU's clock is 200 ppm fast
  gap,               ///< nothing is recorded for 2 s, from two fifths of the time on
  duplicates,        ///< one message in 50 comes twice
  reordering,        ///< one IMU message in 50 comes after the next
  nan,               ///< one return in 20 is not a number
  wrong_units,       ///< acceleration in g, rotation in degrees a second
  swapped_axes,      ///< the IMU is mounted turned by a quarter, and nothing says so
  blocked_sector,    ///< something covers 60 degrees of the range sensor, behind to the left
  shock,             ///< a blow every 4 s: the mount rings at 40 Hz, up to 10 g and 1 rad/s
  own_carrier,       ///< two posts and a box of what carries it are in view of the range sensor
  rain,              ///< drops scatter pulses back and take from what lies behind them
  truncated,         ///< the recorder was killed: the last fifth of the file is missing
  rare_spikes,       ///< one IMU reading in 1000 is damaged: one of its six numbers is anything up
                     ///< to twice what sensors can read
  spikes,            ///< one in 100
  many_spikes,       ///< one in 20
  gaps,              ///< the IMU is silent for 60 to 150 ms, once in each second
  odometry_leap,     ///< the visual odometry leaps by 3 m at half time: it has recognised a place
  odometry_lost,     ///< its pose is that of the start for 5 s, from two fifths of the time on
  heading_off_90,    ///< headings are off by 90 degrees: antennas across, not along
  heading_off_180,   ///< by 180 degrees: the two antennas are exchanged
  heading_noisy,     ///< by 20 degrees (standard deviation), each by another error
  heading_stuck,     ///< the first one is repeated
  heading_outliers,  ///< one in 10 is anything
  camera_turned,  ///< the cameras' transforms err by 1 degree about an axis that is none of theirs
  camera_late,    ///< the images' stamps are 20 ms late
  camera_exposure,            ///< the images get brighter and darker, by a factor of up to 2 each
  wheel_scale,                ///< the wheels read 5 % too much: other tyres than the driver assumes
  wheel_slip,                 ///< they spin: 10 % too much for 2 s, once in every 10 s
  wheel_stuck,                ///< the encoder is dead: always zero
  wheel_units,                ///< km/h
  wheel_reversed,             ///< ahead is reported as back
  wheel_axes,                 ///< x and y are swapped
  wheel_late,                 ///< stamps are 50 ms late
  wheel_zero_covariance,      ///< all zeros, as of drivers that do not know it
  wheel_negative_covariance,  ///< variances of -1
};

/// What a recording has beside range sensors.
struct SimulatedSenses {
  bool imu = true;
  bool wheels = false;
  bool visual_odometry = false;
  bool heading = false;
  bool camera = false;
};

std::vector<std::string> fault_names();

/// clock-offset, clock-drift, ... as above. Throws UsageError for other names, with the nearest.
Fault fault_named(std::string_view name);

/// Throws UsageError where a fault would not be seen in a recording of `duration` (s), since it is
/// one of a sensor that is not there, or where another one hides it.
void require_seen(const std::vector<std::string>& names, double duration,
                  const SimulatedSenses& senses);

/// Applies faults to what a simulation is about to write.
class FaultMaker {
 public:
  /// `duration` of the recording in s.
  FaultMaker(std::vector<Fault> faults, double duration, uint64_t seed);

  bool has(Fault fault) const;

  void distort(RangeSweep& sweep) const;

  /// `sample` with its stamp counted from the start of the recording.
  void distort(ImuSample& sample) const;

  /// `velocity` with its stamp counted from the start of the recording.
  void distort(BodyVelocity& velocity) const;

  /// `pose` with its stamp counted from the start of the recording.
  void distort(ReferencePose& pose) const;

  /// `heading` with its stamp counted from the start of the recording; `first`, of the recording,
  /// is what a source that is stuck repeats.
  void distort(Heading& heading, double first) const;

  /// `image` with its stamp counted from the start of the recording.
  void distort(SimulatedImage& image) const;

  /// What a recording states of where a camera is mounted.
  Eigen::Isometry3d stated_mount(const Eigen::Isometry3d& T_imu_camera) const;

  /// Whether an IMU message that was recorded at `time` from the start is missing on its own.
  bool is_silent(Nanoseconds time) const;

  /// How often message `index` of a topic, recorded at `time` from the start, is written: 0, 1, 2.
  int copies(uint64_t topic, uint64_t index, Nanoseconds time) const;

  /// Whether IMU message `index` is written only after the next.
  bool comes_late(uint64_t index) const;

 private:
  double spiked_share() const;
  bool wheels_slip(Nanoseconds time) const;

  std::vector<Fault> faults_;
  double duration_;
  uint64_t seed_;
};

}  // namespace adit
