// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// What came over time, in so many equal bins that memory stays small: where a recording outgrows
/// them, two bins become one. `BinType` has add(const BinType&), and is nothing where it is new.
template <class BinType>
class Timeline {
 public:
  using Bin = BinType;

  /// The bin of what was received then; what was received before the first counts with it.
  void add(Nanoseconds received, const Bin& one) {
    begin_ = begin_.value_or(received);
    const double after = std::max(
        0.0, 1e-9 * (static_cast<double>(received.count()) - static_cast<double>(begin_->count())));
    while (after / width_ >= kMostBins) {
      double_width();
    }
    const auto index = static_cast<std::size_t>(after / width_);
    bins_.resize(std::max(bins_.size(), index + 1));
    bins_[index].add(one);
  }

  Nanoseconds begin() const { return begin_.value_or(Nanoseconds(0)); }
  double bin_width() const { return width_; }  ///< s
  const std::vector<Bin>& bins() const { return bins_; }

 private:
  static constexpr double kMostBins = 1000.0;

  void double_width() {
    width_ *= 2.0;
    std::vector<Bin> wider((bins_.size() + 1) / 2);
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      wider[i / 2].add(bins_[i]);
    }
    bins_ = std::move(wider);
  }

  std::optional<Nanoseconds> begin_;
  double width_ = 0.1;  // s
  std::vector<Bin> bins_;
};

/// How events came.
struct TopicBin {
  double events = 0.0;
  double largest_interval = 0.0;  ///< s, between two stamps, the later one in this bin
  double least_delay = 0.0;       ///< s from stamp to receipt; both 0 without events
  double greatest_delay = 0.0;

  void add(const TopicBin& other) {
    if (events == 0.0 || other.events == 0.0) {
      *this = events == 0.0 ? other : *this;
      return;
    }
    events += other.events;
    largest_interval = std::max(largest_interval, other.largest_interval);
    least_delay = std::min(least_delay, other.least_delay);
    greatest_delay = std::max(greatest_delay, other.greatest_delay);
  }
};
using TopicTimeline = Timeline<TopicBin>;

/// An event `interval` s after the stamp before (0 for the first) and received `delay` s after its
/// own.
inline TopicBin one_event(double interval, double delay) {
  return {1.0, interval, delay, delay};
}

}  // namespace adit
