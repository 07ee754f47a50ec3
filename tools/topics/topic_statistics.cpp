// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/topics/topic_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "adit/tools/clouds/returns.hpp"
#include "adit/tools/recordings/topic_survey.hpp"

namespace adit {
namespace {

void take(TopicStatistics& topic, const Sweep& sweep, Nanoseconds) {
  SweepStatistics& s = topic.sweeps;
  const auto returns = std::ranges::count_if(sweep.points, is_return);
  s.points.add(static_cast<double>(sweep.points.size()));
  s.returns.add(static_cast<double>(returns));
  s.not_finite += static_cast<uint64_t>(
      std::ranges::count_if(sweep.points, [](const Point& p) { return !is_finite(p); }));
  s.empty += returns == 0 ? 1U : 0U;
  s.without_points += sweep.points.empty() ? 1U : 0U;
  s.with_rings += sweep.rings.empty() ? 0U : 1U;
  s.with_doppler += sweep.doppler.empty() ? 0U : 1U;
  constexpr std::size_t kStride = 7;  // shares no factor with usual numbers of beams
  for (std::size_t i = 0; i < sweep.points.size(); i += kStride) {
    const Point& p = sweep.points[i];
    if (is_return(p)) {
      const double turn = std::atan2(p.y, p.x) / (2.0 * std::numbers::pi) + 1.0;
      const auto bins = static_cast<double>(s.returns_by_azimuth.size());
      ++s.returns_by_azimuth[static_cast<std::size_t>(turn * bins) % s.returns_by_azimuth.size()];
    }
  }
  s.offset = sweep.offset;
  s.with_times += sweep.times.empty() ? 0U : 1U;
  if (!sweep.times.empty() && returns > 0) {
    const auto [first, last] = std::ranges::minmax(sweep.times);
    s.duration.add(static_cast<double>(last - first));
  }
}

void take_healthy(ImuStatistics& s, const ImuSample& sample, Nanoseconds received) {
  s.timeline.add(received, one_reading(sample));
  s.acceleration.add(sample.linear_acceleration.norm());
  if (sample.angular_velocity.allFinite()) {
    s.rotation.add(sample.angular_velocity.norm());
    s.stuck_watch.add(sample);
    const auto longer = [](std::optional<StuckAxis> now, const std::optional<StuckAxis>& before) {
      return !now || (before && before->duration > now->duration) ? before : now;
    };
    s.stuck = longer(s.stuck_watch.stuck(), s.stuck);
    s.unchanged = longer(s.stuck_watch.unchanged(), s.unchanged);
  }
  s.mean_acceleration += (sample.linear_acceleration - s.mean_acceleration) /
                         static_cast<double>(s.acceleration.count);
}

void take(TopicStatistics& topic, const ImuSample& sample, Nanoseconds received) {
  ImuStatistics& s = topic.imu;
  const bool turns = sample.angular_velocity.allFinite();
  const bool no_gyroscope = sample.angular_velocity.array().isNaN().all();
  if (!sample.linear_acceleration.allFinite() || (!turns && !no_gyroscope)) {
    ++s.not_finite;
    return;
  }
  if (no_gyroscope) {
    // The gate wants both; what no sensor reads is found without it.
    if (sample.linear_acceleration.cwiseAbs().maxCoeff() > ReadingLimits{}.acceleration) {
      ++s.impossible;
    } else {
      take_healthy(s, sample, received);
    }
    return;
  }
  for (const GatedReading& known : s.gate.pass(sample)) {
    s.spikes += known.dropped == ImuArrival::spike ? 1U : 0U;
    s.impossible += known.dropped == ImuArrival::impossible ? 1U : 0U;
    if (!known.dropped) {
      take_healthy(s, known.sample, received);
    }
  }
}

void take(TopicStatistics& topic, const GnssFix& fix, Nanoseconds) {
  topic.gnss.without_fix += fix.kind == GnssFixKind::none ? 1U : 0U;
  topic.gnss.without_covariance += fix.covariance ? 0U : 1U;
}

void take(TopicStatistics& topic, const BodyVelocity& velocity, Nanoseconds) {
  VelocityStatistics& s = topic.velocities;
  const Eigen::Array3d& v = velocity.linear.array();
  s.without_covariance += velocity.covariance ? 0U : 1U;
  if (!v.isFinite().any()) {
    ++s.not_finite;
    return;
  }
  const double speed = v.isFinite().select(v, 0.0).matrix().norm();
  s.moving += speed > 0.0 ? 1U : 0U;
  s.speed.add(speed);
}

void take(TopicStatistics& topic, const Heading& heading, Nanoseconds) {
  topic.headings += std::isfinite(heading.yaw) ? 1U : 0U;
}
void take(TopicStatistics&, const ReferencePose&, Nanoseconds) {}
void take(TopicStatistics&, const StaticTransform&, Nanoseconds) {}

uint64_t sum_of(const std::map<std::string, StampStatistics>& series, const auto& count) {
  uint64_t sum = 0;
  for (const auto& [name, one] : series) {
    sum += count(one);
  }
  return sum;
}

}  // namespace

void Extent::add(double value) {
  least = count == 0 ? value : std::min(least, value);
  greatest = count == 0 ? value : std::max(greatest, value);
  sum += value;
  ++count;
}

void StampStatistics::add(Nanoseconds stamp) {
  ++events;
  if (last_ && stamp == *last_) {
    ++repeated;
  } else if (last_ && stamp < *last_) {
    ++backwards;
    farthest_back = std::max(farthest_back, seconds(*last_ - stamp));
  } else if (last_) {
    const double interval = seconds(stamp - *last_);
    intervals.add(interval);
    if (interval > largest_interval) {
      largest_interval = interval;
      largest_interval_at = *last_;
    }
  }
  last_ = stamp;
}

StampStatistics& TopicStatistics::series_of(const Event& event) {
  constexpr std::size_t kMostSeries = 256;  // a robot has fewer frames; noise has not
  const auto* pose = std::get_if<ReferencePose>(&event.value);
  const bool transform = std::holds_alternative<StaticTransform>(event.value);
  const std::string name = pose != nullptr ? pose->child
                           : transform     ? std::string()
                                           : plain_frame(event.frame);
  return series[series.size() < kMostSeries || series.contains(name) ? name : std::string()];
}

void TopicStatistics::add(const Event& event) {
  const Nanoseconds stamp = stamp_of(event);
  ++events;
  bytes += event.bytes;
  if (event.point_times) {
    point_times = event.point_times;
  }
  stamps = stamps ? TimeSpan{std::min(stamps->begin, stamp), std::max(stamps->end, stamp)}
                  : TimeSpan{stamp, stamp};
  delay.add(seconds(event.received - stamp));
  clock.add(event.received, stamp);
  StampStatistics& one = series_of(event);
  const std::optional<Nanoseconds> last = one.last();
  one.add(stamp);
  if (!event.frame.empty() && one.events > frame_events_) {
    frame = event.frame;
    frame_events_ = one.events;
  }
  timeline.add(event.received, one_event(last ? std::max(0.0, seconds(stamp - *last)) : 0.0,
                                         seconds(event.received - stamp)));
  std::visit([&](const auto& value) { take(*this, value, event.received); }, event.value);
  sweeps.coordinate_step = std::max(sweeps.coordinate_step, event.coordinate_step);
}

uint64_t TopicStatistics::repeated() const {
  return sum_of(series, [](const StampStatistics& s) { return s.repeated; });
}
uint64_t TopicStatistics::backwards() const {
  return sum_of(series, [](const StampStatistics& s) { return s.backwards; });
}
uint64_t TopicStatistics::with_points() const {
  return events - sweeps.without_points;
}
uint64_t TopicStatistics::gaps() const {
  return sum_of(series, [](const StampStatistics& s) { return s.gaps(); });
}

double TopicStatistics::largest_interval() const {
  double largest = 0.0;
  for (const auto& [name, one] : series) {
    largest = std::max(largest, one.largest_interval);
  }
  return largest;
}

double TopicStatistics::slowest_period() const {
  double slowest = 0.0;
  for (const auto& [name, one] : series) {
    slowest = std::max(slowest, one.period());
  }
  return slowest;
}

double TopicStatistics::period() const {
  const auto most =
      std::ranges::max_element(series, {}, [](const auto& entry) { return entry.second.events; });
  return most == series.end() ? 0.0 : most->second.period();
}

double TopicStatistics::span() const {
  if (series.size() > 1) {  // frames of poses, each with a clock of its own
    return stamps ? seconds(stamps->end - stamps->begin) : 0.0;
  }
  return clock.span();
}

bool TopicStatistics::lasts() const {
  constexpr double kLeastSpan = 1e-3;  // s: latched messages follow each other within less
  return span() >= kLeastSpan;
}

double TopicStatistics::rate() const {
  return lasts() ? static_cast<double>(events - 1) / span() : 0.0;
}

std::optional<Sector> SweepStatistics::blocked_sector() const {
  constexpr uint64_t kLeastReturns = 20;  // a direction of the others, on average
  constexpr std::size_t kLeastBins = 3;
  constexpr uint64_t kNone = 100;  // a hundredth of the others' median is none
  const std::size_t bins = returns_by_azimuth.size();
  auto sorted = returns_by_azimuth;
  std::ranges::sort(sorted);
  const uint64_t usual = sorted[bins * 3 / 4];
  const auto hidden = [&](std::size_t i) { return returns_by_azimuth[i % bins] * kNone < usual; };
  std::size_t begin = 0;
  std::size_t widest = 0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < bins; ++i) {
    all += hidden(i) ? 1U : 0U;
    std::size_t width = 0;
    while (width < bins && hidden(i + width)) {
      ++width;
    }
    if (width > widest) {
      begin = i;
      widest = width;
    }
  }
  if (usual < kLeastReturns || widest < kLeastBins || all > bins / 2) {
    return std::nullopt;
  }
  const double width = 360.0 / static_cast<double>(bins);
  return Sector{width * static_cast<double>(begin), width * static_cast<double>(begin + widest)};
}

bool TopicStatistics::point_times_fit() const {
  // Points that were all taken at once tell no unit.
  if (sweeps.duration.count < 2 || sweeps.duration.greatest <= 0.0 || period() <= 0.0) {
    return true;
  }
  const double ratio = sweeps.duration.mean() / period();
  return ratio > 0.02 && ratio < 1.5;
}

std::optional<double> TopicStatistics::better_time_unit() const {
  for (int power = 0; point_times && period() > 0.0 && power >= -9; power -= 3) {
    const double unit = std::pow(10.0, power);
    const double ratio = sweeps.duration.mean() / point_times->unit * unit / period();
    if (ratio > 0.2 && ratio < 1.2) {
      return unit;
    }
  }
  return std::nullopt;
}

}  // namespace adit
