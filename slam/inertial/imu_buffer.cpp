// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/imu_buffer.hpp"

#include <algorithm>

#include "adit/slam/core/nav_state.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kClockSetBack = std::chrono::seconds(1);

bool earlier(const ImuSample& a, const ImuSample& b) {
  return a.stamp < b.stamp;
}

ImuSample held(const ImuSample& sample, Nanoseconds stamp) {
  ImuSample moved = sample;
  moved.stamp = stamp;
  return moved;
}

}  // namespace

std::string_view to_string(ImuArrival arrival) {
  switch (arrival) {
    case ImuArrival::appended:
      return "appended";
    case ImuArrival::inserted:
      return "inserted";
    case ImuArrival::duplicate:
      return "duplicate";
    case ImuArrival::too_late:
      return "too late";
    case ImuArrival::restarted:
      return "restarted";
    case ImuArrival::not_finite:
      return "not finite";
    case ImuArrival::impossible:
      return "impossible";
    case ImuArrival::spike:
      return "spike";
  }
  return "unknown";
}

ImuSample interpolate(const ImuSample& a, const ImuSample& b, Nanoseconds stamp) {
  const double whole = seconds(b.stamp - a.stamp);
  const double s = whole > 0.0 ? seconds(stamp - a.stamp) / whole : 0.0;
  return {stamp, a.angular_velocity + s * (b.angular_velocity - a.angular_velocity),
          a.linear_acceleration + s * (b.linear_acceleration - a.linear_acceleration)};
}

ImuArrival ImuBuffer::push(const ImuSample& sample) {
  if (!sample.angular_velocity.allFinite() || !sample.linear_acceleration.allFinite()) {
    return ImuArrival::not_finite;
  }
  if (samples_.empty() || samples_.back().stamp < sample.stamp) {
    samples_.push_back(sample);
    return ImuArrival::appended;
  }
  if (samples_.back().stamp - sample.stamp > kClockSetBack) {
    samples_.clear();
    samples_.push_back(sample);
    return ImuArrival::restarted;
  }
  const auto place = std::lower_bound(samples_.begin(), samples_.end(), sample, earlier);
  if (place->stamp == sample.stamp) {
    return ImuArrival::duplicate;
  }
  if (place == samples_.begin()) {
    return ImuArrival::too_late;
  }
  samples_.insert(place, sample);
  return ImuArrival::inserted;
}

ImuInterval ImuBuffer::between(Nanoseconds begin, Nanoseconds end) const {
  ImuInterval interval;
  if (samples_.empty() || end <= begin) {
    return interval;
  }
  // Neighbours of the two ends; the same reading twice where the buffer does not reach.
  const auto at = [&](Nanoseconds stamp) {
    const auto next = std::lower_bound(samples_.begin(), samples_.end(), held({}, stamp), earlier);
    if (next == samples_.begin() || next == samples_.end()) {
      return held(next == samples_.end() ? samples_.back() : *next, stamp);
    }
    return interpolate(*(next - 1), *next, stamp);
  };
  const auto first = std::upper_bound(samples_.begin(), samples_.end(), held({}, begin), earlier);
  const auto last = std::lower_bound(first, samples_.end(), held({}, end), earlier);
  interval.samples.push_back(at(begin));
  interval.samples.insert(interval.samples.end(), first, last);
  interval.samples.push_back(at(end));

  const Nanoseconds none{0};
  interval.held_before = seconds(std::max(none, std::min(front().stamp, end) - begin));
  interval.held_after = seconds(std::max(none, end - std::max(back().stamp, begin)));
  // Gaps are those of the readings, which may begin before the interval and end after it.
  const auto from = first == samples_.begin() ? first : first - 1;
  const auto to = last == samples_.end() ? last : last + 1;
  for (auto next = from; next != to && next + 1 != to; ++next) {
    interval.longest_gap = std::max(interval.longest_gap, seconds((next + 1)->stamp - next->stamp));
  }
  return interval;
}

void ImuBuffer::shift(Nanoseconds by) {
  for (ImuSample& sample : samples_) {
    sample.stamp += by;
  }
}

void ImuBuffer::forget_before(Nanoseconds stamp) {
  while (samples_.size() >= 2 && samples_[1].stamp <= stamp) {
    samples_.pop_front();
  }
}

}  // namespace adit
