// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/executor/sensor_feed.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace adit {
namespace {

constexpr Nanoseconds kLongestWait = std::chrono::milliseconds(300);
/// However far stamps and order of arrival disagree, and where a clock stands still.
constexpr std::size_t kMostHeldBytes = std::size_t{256} << 20U;

std::size_t size_of(const Measurement& measurement) {
  const auto* sweep = std::get_if<Sweep>(&measurement);
  return sizeof(Measurement) + (sweep == nullptr ? 0 : bytes_of(*sweep));
}

Nanoseconds end_of(const Sweep& sweep) {
  return sweep.stamp + nanoseconds(duration_of(sweep));
}

}  // namespace

Nanoseconds stamp_of(const Measurement& measurement) {
  return std::visit([](const auto& value) { return value.stamp; }, measurement);
}

void SensorFeed::add(Measurement measurement) {
  flushing_ = false;
  if (!waits_) {
    release(std::move(measurement));
    return;
  }
  const Nanoseconds stamp = stamp_of(measurement);
  latest_arrival_ = std::max(latest_arrival_, stamp);
  held_bytes_ += size_of(measurement);
  held_.emplace(stamp, std::move(measurement));  // behind those of the same stamp
}

void SensorFeed::flush() {
  flushing_ = true;
}

bool SensorFeed::is_due() const {
  return !held_.empty() && (flushing_ || latest_arrival_ - held_.begin()->first >= window_ ||
                            held_bytes_ > kMostHeldBytes);
}

bool SensorFeed::front_is_covered() const {
  if (waiting_.empty()) {
    return false;
  }
  const Nanoseconds end = waiting_.front().end;
  return !waits_ || (flushing_ && held_.empty()) || newest_reading_ >= end ||
         newest_ > end + kLongestWait;
}

void SensorFeed::release(Measurement measurement) {
  newest_ = std::max(newest_, stamp_of(measurement));
  if (auto* sweep = std::get_if<Sweep>(&measurement)) {
    const Nanoseconds end = waits_ ? end_of(*sweep) : sweep->stamp;
    waiting_.push_back({.sweep = std::move(*sweep), .end = end});
    return;
  }
  if (const auto* reading = std::get_if<ImuSample>(&measurement)) {
    newest_reading_ = std::max(newest_reading_, reading->stamp);
  }
  ready_.push_back(std::move(measurement));
}

std::optional<Measurement> SensorFeed::next() {
  while (ready_.empty()) {
    if (front_is_covered()) {
      Sweep sweep = std::move(waiting_.front().sweep);
      waiting_.pop_front();
      return sweep;
    }
    if (!is_due()) {
      return std::nullopt;
    }
    Measurement first = std::move(held_.extract(held_.begin()).mapped());
    held_bytes_ -= size_of(first);
    release(std::move(first));
  }
  Measurement next = std::move(ready_.front());
  ready_.pop_front();
  return next;
}

}  // namespace adit
