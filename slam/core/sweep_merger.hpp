// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/core/types.hpp"

namespace adit {

/// One of the range sensors that SweepMerger makes one of.
struct MergedSensor {
  Eigen::Isometry3d T_lidar_sensor = Eigen::Isometry3d::Identity();  ///< lidar: the first sensor
  double c_min = 0.0;     ///< m, returns nearer to this sensor are dropped
  double c_max = 1000.0;  ///< m, returns farther from it are dropped
};

/// What became of a sensor's sweeps.
struct MergedCount {
  std::size_t sweeps = 0;    ///< that were added
  uint64_t points = 0;       ///< that are in merged sweeps, returns or not
  uint64_t late_points = 0;  ///< left out: the merged sweep of their time had been given out
  std::size_t merged = 0;    ///< merged sweeps with points of this sensor
};

/// Merges the sweeps of several range sensors, of other models, rates and starts, into one series
/// in the axes of the first sensor.
///
/// Time is cut where the sweeps of one sensor begin, the first that is alive; each point goes by
/// its own time into the merged sweep that covers it, so that none counts twice and de-skewing sees
/// when each was measured. A merged sweep is given out once each sensor has sent what belongs to
/// it. A sensor that is two of its periods behind the newest sweep is silent: nobody waits for it
/// until it sends again. Where that one is the sensor at whose sweeps time is cut, the next one
/// takes its place, for good.
///
/// Only stamps decide: the same sweeps in the same order of arrival give the same bytes.
class SweepMerger {
 public:
  /// At least one sensor. Throws std::invalid_argument for none.
  explicit SweepMerger(const std::vector<MergedSensor>& sensors);

  /// Takes a sweep of a sensor, by its place in the list.
  void add(std::size_t sensor, Sweep sweep);

  /// No further sweep comes: next() gives what still waits. add() may go on after that.
  void flush() { flushing_ = true; }

  /// The next merged sweep; nothing where it needs further sweeps, or a flush(). Its stamp is that
  /// of the sweep at which it was cut, or of an earlier point. Doppler speeds are those of the
  /// first sensor's points alone, since each is along the ray from its own sensor; those of others
  /// are NaN.
  std::optional<Sweep> next();

  /// By sensor.
  std::vector<MergedCount> counts() const;

 private:
  struct Source {
    MergedSensor sensor;
    std::deque<Sweep> pending{};          ///< in the lidar's axes, with a time for each point
    std::deque<double> intervals{};       ///< s, between the latest stamps
    std::optional<Nanoseconds> newest{};  ///< stamp
    MergedCount count{};
  };

  Nanoseconds period(const Source& source) const;
  bool is_silent(const Source& source) const;
  std::optional<Nanoseconds> next_end() const;
  bool have_all_reached(Nanoseconds end) const;
  std::optional<std::size_t> next_lead() const;
  Sweep merged(Nanoseconds end);

  std::vector<Source> sources_;
  std::size_t lead_ = 0;  ///< at whose sweeps time is cut
  bool flushing_ = false;
  std::optional<Nanoseconds> begin_{};   ///< where the last merged sweep ended
  Nanoseconds last_{0};                  ///< stamp of that one
  std::optional<Nanoseconds> first_{};   ///< stamp of the first sweep that came
  std::optional<Nanoseconds> newest_{};  ///< stamp of all
};

}  // namespace adit
