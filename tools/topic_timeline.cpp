// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/topic_timeline.hpp"

#include <algorithm>

namespace adit {
namespace {

constexpr double kMostBins = 1000.0;

/// Two neighbours as one.
TopicTimeline::Bin merged(const TopicTimeline::Bin& a, const TopicTimeline::Bin& b) {
  if (a.events == 0.0 || b.events == 0.0) {
    return a.events == 0.0 ? b : a;
  }
  return {a.events + b.events, std::max(a.largest_interval, b.largest_interval),
          std::min(a.least_delay, b.least_delay), std::max(a.greatest_delay, b.greatest_delay)};
}

}  // namespace

void TopicTimeline::double_width() {
  width_ *= 2.0;
  for (std::size_t i = 0; i < bins_.size(); i += 2) {
    bins_[i / 2] = i + 1 < bins_.size() ? merged(bins_[i], bins_[i + 1]) : bins_[i];
  }
  bins_.resize((bins_.size() + 1) / 2);
}

void TopicTimeline::add(Nanoseconds received, double interval, double delay) {
  begin_ = begin_.value_or(received);
  const double after = std::max(
      0.0, 1e-9 * (static_cast<double>(received.count()) - static_cast<double>(begin_->count())));
  while (after / width_ >= kMostBins) {
    double_width();
  }
  const auto index = static_cast<std::size_t>(after / width_);
  bins_.resize(std::max(bins_.size(), index + 1));
  bins_[index] = merged(bins_[index], {1.0, interval, delay, delay});
}

}  // namespace adit
