// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/share_statistics.hpp"

#include <cmath>

namespace adit {

void ShareStatistics::add(const InertialReport& report) {
  if (report.shares) {
    for (std::size_t i = 0; i < kMotionSources; ++i) {
      for (std::size_t k = 0; k < kMotionParts; ++k) {
        sum_.of[i][k] += report.shares->of[i][k];
      }
    }
    ++sweeps_;
    moved_ += report.shares->moved ? 1U : 0U;
  }
  if (report.innovation.degrees > 0 && std::isfinite(report.innovation.nis)) {
    squares_ += report.innovation.nis;
    degrees_ += report.innovation.degrees;
  }
}

std::vector<std::pair<std::string, double>> ShareStatistics::of(MotionSource source) const {
  std::vector<std::pair<std::string, double>> shares;
  for (std::size_t k = 0; k < kMotionParts; ++k) {
    const auto part = static_cast<MotionPart>(k);
    const bool of_path = part == MotionPart::along || part == MotionPart::across;
    const std::size_t sweeps = of_path ? moved_ : sweeps_;
    if (sweeps > 0) {
      shares.emplace_back(to_string(part), sum_(source, part) / static_cast<double>(sweeps));
    }
  }
  return shares;
}

std::optional<double> ShareStatistics::innovation_squared() const {
  return degrees_ > 0.0 ? std::optional(squares_ / degrees_) : std::nullopt;
}

}  // namespace adit
