// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/inspection/rotation_profile.hpp"

#include <algorithm>

namespace adit {

void RotationProfile::add(Nanoseconds received, const Eigen::Vector3d& angular_velocity) {
  if (!angular_velocity.allFinite()) {
    return;
  }
  Second& second = seconds_[std::chrono::floor<std::chrono::seconds>(received).count()];
  second.samples += 1.0;
  second.sum += angular_velocity;
  second.squares += angular_velocity.squaredNorm();
}

std::optional<TimeSpan> RotationProfile::liveliest(Nanoseconds length) const {
  if (seconds_.empty()) {
    return std::nullopt;
  }
  const int64_t width =
      std::max<int64_t>(1, std::chrono::ceil<std::chrono::seconds>(length).count());
  double greatest = -1.0;
  int64_t begin = seconds_.begin()->first;
  Second window;
  const auto take = [&](const Second& second, double sign) {
    window.samples += sign * second.samples;
    window.sum += sign * second.sum;
    window.squares += sign * second.squares;
  };
  auto last = seconds_.begin();  // behind the window
  for (auto first = seconds_.begin(); first != seconds_.end(); ++first) {
    for (; last != seconds_.end() && last->first < first->first + width; ++last) {
      take(last->second, 1.0);
    }
    // The sum of squares about the mean: turning steadily tells nothing.
    const double change = window.squares - window.sum.squaredNorm() / window.samples;
    if (change > greatest * (1.0 + 1e-9)) {
      greatest = change;
      begin = first->first;
    }
    take(first->second, -1.0);
  }
  return TimeSpan{std::chrono::seconds(begin),
                  std::chrono::seconds(begin + width) - Nanoseconds(1)};
}

}  // namespace adit
