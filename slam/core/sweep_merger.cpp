// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/sweep_merger.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "adit/slam/core/farthest_point_time.hpp"
#include "adit/slam/core/median.hpp"

namespace adit {
namespace {

// Sensors turn 5 to 20 times a second; before the second sweep of one nothing says how often.
constexpr double kUsualPeriod = 0.1;  // s
// The median of so many intervals is right where four of them are not.
constexpr std::size_t kIntervals = 9;
// A sensor that is silent for so many of its periods is not waited for: one message may be lost,
// two in a row rarely are.
constexpr int kSilentPeriods = 2;
// Sweeps of one sensor that wait for another: seconds of them, whatever their stamps say.
constexpr std::ptrdiff_t kMostPending = 64;
constexpr float kNotMeasured = std::numeric_limits<float>::quiet_NaN();

/// In the lidar's axes; each point has a time, and those out of the sensor's range are none.
Sweep in_lidar_axes(Sweep sweep, const MergedSensor& sensor) {
  const double nearest = sensor.c_min * sensor.c_min;
  const double farthest = sensor.c_max * sensor.c_max;
  for (Point& point : sweep.points) {
    const Eigen::Vector3d p = Eigen::Vector3d(point.x, point.y, point.z) + sweep.offset;
    const double squared = p.squaredNorm();
    if (!(squared > 0.0 && squared >= nearest && squared <= farthest)) {
      point = Point{.intensity = point.intensity};
      continue;
    }
    const Eigen::Vector3f q = (sensor.T_lidar_sensor * p).cast<float>();
    point.x = q.x();
    point.y = q.y();
    point.z = q.z();
  }
  sweep.offset.setZero();
  sweep.times.resize(sweep.points.size(), 0.0F);
  return sweep;
}

Nanoseconds time_of(const Sweep& sweep, std::size_t i) {
  const float time = sweep.times[i];
  return std::abs(time) <= kFarthestPointTime ? sweep.stamp + nanoseconds(static_cast<double>(time))
                                              : sweep.stamp;
}

/// A value of a list that not each sensor has.
template <class Value>
void append(std::vector<Value>& to, std::size_t before, const std::vector<Value>& from,
            std::size_t i, Value missing) {
  if (!from.empty() || !to.empty()) {
    to.resize(before, missing);
    to.push_back(from.empty() ? missing : from[i]);
  }
}

/// The points from a time on.
Sweep rest_of(const Sweep& sweep, Nanoseconds begin) {
  Sweep rest;
  rest.stamp = sweep.stamp;
  rest.source = sweep.source;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    if (time_of(sweep, i) >= begin) {
      append(rest.rings, rest.points.size(), sweep.rings, i, uint16_t{0});
      append(rest.doppler, rest.points.size(), sweep.doppler, i, kNotMeasured);
      rest.points.push_back(sweep.points[i]);
      rest.times.push_back(sweep.times[i]);
    }
  }
  return rest;
}

}  // namespace

SweepMerger::SweepMerger(const std::vector<MergedSensor>& sensors) {
  if (sensors.empty()) {
    throw std::invalid_argument("SweepMerger: there is no sensor");
  }
  for (const MergedSensor& sensor : sensors) {
    sources_.push_back({.sensor = sensor});
  }
}

void SweepMerger::add(std::size_t sensor, Sweep sweep) {
  Source& source = sources_.at(sensor);
  if (source.newest == sweep.stamp) {
    source.count.late_points += sweep.points.size();  // a message that was sent twice
    return;
  }
  if (source.newest && sweep.stamp > *source.newest) {
    source.intervals.push_back(
        std::min<double>(seconds(sweep.stamp - *source.newest), kFarthestPointTime));
    if (source.intervals.size() > kIntervals) {
      source.intervals.pop_front();
    }
  }
  source.newest = std::max(source.newest.value_or(sweep.stamp), sweep.stamp);
  newest_ = std::max(newest_.value_or(sweep.stamp), sweep.stamp);
  first_ = first_.value_or(sweep.stamp);
  ++source.count.sweeps;
  flushing_ = false;
  if (sensor > 0 && !sweep.doppler.empty()) {
    sweep.doppler.assign(sweep.doppler.size(), kNotMeasured);
  }
  const auto place = std::ranges::upper_bound(source.pending, sweep.stamp, {}, &Sweep::stamp);
  source.pending.insert(place, in_lidar_axes(std::move(sweep), source.sensor));
}

Nanoseconds SweepMerger::period(const Source& source) const {
  return nanoseconds(source.intervals.empty()
                         ? kUsualPeriod
                         : median({source.intervals.begin(), source.intervals.end()}));
}

bool SweepMerger::is_silent(const Source& source) const {
  const auto waits = std::ranges::count_if(sources_[lead_].pending, [&](const Sweep& sweep) {
    return !begin_ || sweep.stamp >= *begin_;
  });
  return flushing_ || waits > kMostPending ||
         *newest_ - source.newest.value_or(*first_) > (kSilentPeriods + 1) * period(source);
}

/// Where the next sweep of the lead begins, or should: of the first that has more than half of its
/// time before it.
std::optional<Nanoseconds> SweepMerger::next_end() const {
  const Source& lead = sources_[lead_];
  const Nanoseconds usual = period(lead);
  for (std::size_t i = 0; i < lead.pending.size(); ++i) {
    const bool is_last = i + 1 == lead.pending.size();
    if (is_last && lead.intervals.empty() && !is_silent(lead)) {
      return std::nullopt;  // its period is not known yet
    }
    const Nanoseconds due = lead.pending[i].stamp + usual;
    const Nanoseconds end = is_last ? due : std::min(lead.pending[i + 1].stamp, due + usual / 2);
    if (!begin_ || end >= *begin_ + usual / 2) {
      return end;
    }
  }
  return std::nullopt;
}

bool SweepMerger::have_all_reached(Nanoseconds end) const {
  return std::ranges::all_of(sources_, [&](const Source& source) {
    return &source == &sources_[lead_] || is_silent(source) ||
           (source.newest && *source.newest + period(source) >= end);
  });
}

/// The first sensor that still sends.
std::optional<std::size_t> SweepMerger::next_lead() const {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (!sources_[i].pending.empty() && (flushing_ || !is_silent(sources_[i]))) {
      return i;
    }
  }
  return std::nullopt;
}

std::optional<Sweep> SweepMerger::next() {
  while (newest_) {
    if (const auto end = next_end()) {
      return have_all_reached(*end) ? std::optional(merged(*end)) : std::nullopt;
    }
    if (!is_silent(sources_[lead_])) {
      return std::nullopt;
    }
    sources_[lead_].pending.clear();  // too little for a sweep
    const auto next = next_lead();
    if (!next) {
      return std::nullopt;
    }
    lead_ = *next;
  }
  return std::nullopt;
}

Sweep SweepMerger::merged(Nanoseconds end) {
  const Source& lead = sources_[lead_];
  const Nanoseconds earliest = begin_ ? std::max(*begin_ - period(lead) / 2, last_ + Nanoseconds(1))
                                      : lead.pending.front().stamp;
  const auto is_in = [&](Nanoseconds time) { return time >= earliest && time < end; };
  Nanoseconds stamp = std::max(lead.pending.front().stamp, earliest);
  for (const Source& source : sources_) {
    for (const Sweep& sweep : source.pending) {
      for (std::size_t i = 0; i < sweep.points.size(); ++i) {
        const Nanoseconds time = time_of(sweep, i);
        stamp = is_in(time) ? std::min(stamp, time) : stamp;
      }
    }
  }
  Sweep result;
  result.stamp = stamp;
  result.source = lead.pending.front().source;
  for (Source& source : sources_) {
    const std::size_t before = result.points.size();
    for (Sweep& sweep : source.pending) {
      for (std::size_t i = 0; i < sweep.points.size(); ++i) {
        const Nanoseconds time = time_of(sweep, i);
        source.count.late_points += time < earliest ? 1U : 0U;
        if (is_in(time)) {
          append(result.rings, result.points.size(), sweep.rings, i, uint16_t{0});
          append(result.doppler, result.points.size(), sweep.doppler, i, kNotMeasured);
          result.points.push_back(sweep.points[i]);
          result.times.push_back(static_cast<float>(seconds(time - stamp)));
        }
      }
      sweep = rest_of(sweep, end);
    }
    source.count.points += result.points.size() - before;
    source.count.merged += result.points.size() > before ? 1U : 0U;
    std::erase_if(source.pending,
                  [&](const Sweep& sweep) { return sweep.points.empty() && sweep.stamp < end; });
  }
  if (!result.rings.empty()) {
    result.rings.resize(result.points.size());
  }
  if (!result.doppler.empty()) {
    result.doppler.resize(result.points.size(), kNotMeasured);
  }
  begin_ = end;
  last_ = stamp;
  return result;
}

std::vector<MergedCount> SweepMerger::counts() const {
  std::vector<MergedCount> counts;
  for (const Source& source : sources_) {
    counts.push_back(source.count);
  }
  return counts;
}

}  // namespace adit
