// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/duration_sample.hpp"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr std::size_t kMostKept = 8192;

}  // namespace

void DurationSample::add(double ms) {
  if (count_ % stride_ == 0) {
    kept_.push_back(static_cast<float>(ms));
  }
  ++count_;
  last_ms_ = ms;
  sum_ms_ += ms;
  if (kept_.size() > kMostKept) {
    std::size_t k = 0;
    std::erase_if(kept_, [&](float) { return k++ % 2 == 1; });
    stride_ *= 2;
  }
}

double DurationSample::quantile_ms(double share) const {
  if (kept_.empty()) {
    return 0.0;
  }
  std::vector<float> sorted = kept_;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::ranges::nth_element(sorted, at);
  return static_cast<double>(*at);
}

}  // namespace adit
