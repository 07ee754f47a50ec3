// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the events of a topic are like, counted while they pass; memory does not grow with them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "adit/slam/core/types.hpp"
#include "adit/slam/inertial/reading_gate.hpp"
#include "adit/slam/inertial/stuck_axis.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/topics/clock_watch.hpp"
#include "adit/tools/topics/imu_timeline.hpp"
#include "adit/tools/topics/interval_histogram.hpp"
#include "adit/tools/topics/timeline.hpp"

namespace adit {

/// Least, mean and greatest of numbers that pass.
struct Extent {
  uint64_t count = 0;
  double least = 0.0;
  double greatest = 0.0;
  double sum = 0.0;

  void add(double value);
  double mean() const { return count == 0 ? 0.0 : sum / static_cast<double>(count); }
};

struct ImuStatistics {
  Extent acceleration;  ///< norm, m/s² if the sensor's unit is that
  Extent rotation;      ///< norm, rad/s
  Eigen::Vector3d mean_acceleration = Eigen::Vector3d::Zero();
  uint64_t not_finite = 0;  ///< samples with a number that is none
  uint64_t impossible = 0;  ///< beyond what any sensor reads
  StuckAxisWatch stuck_watch;
  std::optional<StuckAxis> stuck;      ///< the longest time that an axis was
  std::optional<StuckAxis> unchanged;  ///< that it may have been
  uint64_t spikes = 0;                 ///< far from those before and after, which agree
  ImuTimeline timeline;                ///< the other samples
  ReadingGate gate{{}};                ///< tells them
};

/// Directions about the sensor's z axis.
struct Sector {
  double begin = 0.0;  ///< degrees from x towards y, 0 to 360
  double end = 0.0;    ///< degrees, greater than `begin`; may be beyond 360
};

struct SweepStatistics {
  Extent points;            ///< a sweep
  Extent returns;           ///< a sweep: points that are finite and not (0, 0, 0)
  uint64_t not_finite = 0;  ///< points, of all sweeps
  Extent duration;  ///< s, from the first to the last point; only sweeps with times and returns
  uint64_t with_times = 0;      ///< sweeps
  uint64_t empty = 0;           ///< sweeps without a return
  uint64_t without_points = 0;  ///< sweeps, of the empty ones
  uint64_t with_rings = 0;      ///< sweeps
  uint64_t with_doppler = 0;    ///< sweeps
  /// Returns for some points of each sweep, by azimuth from 0 on, 5 degrees each.
  std::array<uint64_t, 72> returns_by_azimuth{};
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< m, Sweep::offset
  double coordinate_step = 0.0;                      ///< m, the largest of Event::coordinate_step

  /// The widest sector of 15 degrees or more without returns, of a sensor that sees most directions
  /// about it; a sensor that does not has a field of view.
  std::optional<Sector> blocked_sector() const;
};

struct GnssStatistics {
  uint64_t without_fix = 0;
  uint64_t without_covariance = 0;
};

struct VelocityStatistics {
  Extent speed;                     ///< m/s, of the axes that are measured
  uint64_t not_finite = 0;          ///< velocities without a number
  uint64_t without_covariance = 0;  ///< velocities
  uint64_t moving = 0;              ///< velocities that are not zero
};

/// How the stamps of a series follow each other.
struct StampStatistics {
  uint64_t events = 0;
  uint64_t repeated = 0;               ///< stamps equal to the one before
  uint64_t backwards = 0;              ///< stamps before the one before
  double farthest_back = 0.0;          ///< s, of these
  IntervalHistogram intervals;         ///< s between stamps, where they increase
  double largest_interval = 0.0;       ///< s
  Nanoseconds largest_interval_at{0};  ///< its start

  void add(Nanoseconds stamp);

  std::optional<Nanoseconds> last() const { return last_; }
  /// Typical time between events (s), 0 where there are not two.
  double period() const { return intervals.quantile(0.5); }
  /// Intervals of more than two and a half periods.
  uint64_t gaps() const { return intervals.longer_than(2.5 * period()); }
  /// Enough of them to tell which one is unusual.
  bool tells_gaps() const { return intervals.count() >= 3; }

 private:
  std::optional<Nanoseconds> last_;
};

/// A topic as it was read.
struct TopicStatistics {
  uint64_t events = 0;
  uint64_t bytes = 0;
  std::string frame;                           ///< the sensor's, by most events that name one
  std::optional<PointTimeNature> point_times;  ///< as those of the last sweep with times
  std::optional<TimeSpan> stamps;              ///< the first and the last in time
  Extent delay;                                ///< s from the stamp to the receipt
  ClockWatch clock;                            ///< the sensor's against the recorder's
  /// By what a message is of: the child frame of poses (a topic such as /tf has many), else the
  /// frame of the sensor, without leading slashes.
  std::map<std::string, StampStatistics> series;
  TopicTimeline timeline;
  ImuStatistics imu;
  SweepStatistics sweeps;
  GnssStatistics gnss;
  VelocityStatistics velocities;
  uint64_t headings = 0;  ///< finite ones

  void add(const Event& event);

  double span() const;         ///< s, from the first stamp to the last, without steps of the clock
  bool lasts() const;          ///< long enough for a rate and for plots over time
  double rate() const;         ///< events a second on average, 0 where it does not last
  uint64_t repeated() const;   ///< sum over all series, as in StampStatistics
  uint64_t backwards() const;  ///< likewise
  uint64_t with_points() const;     ///< sweeps that have points
  uint64_t gaps() const;            ///< likewise
  double largest_interval() const;  ///< s, of all series
  double period() const;            ///< s, of the series with the most events
  double slowest_period() const;    ///< s, of the series with the longest
  /// By their points' times sweeps last about as long as it takes to the next. True where there are
  /// no times, or no period to compare with.
  bool point_times_fit() const;
  /// The power of ten (s) that would make them fit instead; nothing where none does.
  std::optional<double> better_time_unit() const;

 private:
  StampStatistics& series_of(const Event& event);

  uint64_t frame_events_ = 0;  ///< of `frame`
};

}  // namespace adit
