// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/laz_series.hpp"

namespace adit {

uint32_t PulseTimes::other_sequence(int64_t time) const {
  for (uint32_t i = 1; i < 4; ++i) {
    if (is_near(between(times_[(current_ + i) & 3U], time))) {
      return i;
    }
  }
  return 0;
}

uint32_t PulseTimes::multiple_of(int64_t difference) const {
  const float ratio = static_cast<float>(difference) / static_cast<float>(steps_[current_]);
  const float rounded = ratio + (ratio >= 0.0F ? 0.5F : -0.5F);
  const auto multiple = static_cast<int32_t>(
      std::clamp(rounded, static_cast<float>(kLeast), static_cast<float>(kMost)));
  return static_cast<uint32_t>(multiple >= 0 ? multiple : kMost - multiple);
}

}  // namespace adit
