// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/topics/interval_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr double kLeast = 1e-7;  // s
constexpr double kWidth = 0.02;  // width of a bin, in the logarithm

}  // namespace

std::size_t IntervalHistogram::bin_of(double seconds) {
  const double bin = std::log(std::max(seconds, kLeast) / kLeast) / kWidth;
  return std::min(static_cast<std::size_t>(bin), kBins - 1);
}

void IntervalHistogram::add(double seconds) {
  ++bins_[bin_of(seconds)];
  ++count_;
}

double IntervalHistogram::quantile(double share) const {
  const auto wanted = static_cast<uint64_t>(std::ceil(share * static_cast<double>(count_)));
  uint64_t seen = 0;
  for (std::size_t i = 0; i < kBins && count_ > 0; ++i) {
    seen += bins_[i];
    if (seen >= std::max<uint64_t>(wanted, 1)) {
      return kLeast * std::exp((static_cast<double>(i) + 0.5) * kWidth);
    }
  }
  return 0.0;
}

uint64_t IntervalHistogram::longer_than(double seconds) const {
  uint64_t longer = 0;
  for (std::size_t i = bin_of(seconds) + 1; i < kBins; ++i) {
    longer += bins_[i];
  }
  return longer;
}

}  // namespace adit
