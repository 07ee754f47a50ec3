// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/surface_color.hpp"

#include <cmath>
#include <cstddef>

namespace adit {
namespace {

// A pixel of a camera with 400 pixels of focal length covers 25 mm at 10 m: the finer features are
// six of them, and the points of a map are placed better than that.
constexpr double kFeature = 0.5;       // m
constexpr double kFineFeature = 0.15;  // m
// The pattern only darkens, so no channel is cut off at 255: from 0.32 to all of the material's.
constexpr double kMiddle = 0.66;
constexpr double kTint = 0.24;      // of each channel
constexpr double kFineTint = 0.10;  // of all three

/// The pattern is another one than that of a scene's uneven surfaces, which have the same seed.
constexpr uint64_t kOfPatterns = 0x5bd1e995c0105a17U;

}  // namespace

SurfaceColor surface_color(Material material, const Eigen::Vector3d& position, uint64_t seed) {
  const SurfaceColor own = optics_of(material).color;
  const uint64_t first = seed ^ kOfPatterns;
  const double fine = kFineTint * value_noise(position / kFineFeature, first);
  SurfaceColor color{};
  for (std::size_t channel = 0; channel < color.size(); ++channel) {
    const double tint = value_noise(position / kFeature, first + 1U + channel);
    const double share = kMiddle + kTint * tint + fine;
    color[channel] = static_cast<uint8_t>(std::floor(share * own[channel] + 0.5));
  }
  return color;
}

}  // namespace adit
