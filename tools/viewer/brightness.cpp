// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/brightness.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace adit {
namespace {

constexpr std::size_t kUsualShare = 98;  // of 100 points
constexpr std::size_t kMostSampled = 1'000'000;

}  // namespace

float usual_brightest(std::span<const Point> points) {
  std::vector<float> some;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kMostSampled);
  for (std::size_t i = 0; i < points.size(); i += stride) {
    if (std::isfinite(points[i].intensity)) {
      some.push_back(points[i].intensity);
    }
  }
  if (some.empty()) {
    return 0.0F;
  }
  const auto at = some.begin() + static_cast<std::ptrdiff_t>(some.size() * kUsualShare / 100);
  std::ranges::nth_element(some, at);
  return std::max(0.0F, *at);
}

uint8_t brightness_of(float intensity, float brightest) {
  const float share = brightest > 0.0F ? intensity / brightest : 0.0F;
  return static_cast<uint8_t>(std::isfinite(share) ? std::clamp(255.0F * share, 0.0F, 255.0F)
                                                   : 0.0F);
}

}  // namespace adit
