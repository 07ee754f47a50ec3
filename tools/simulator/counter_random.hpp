// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Core>

#include "adit/tools/simulator/repeatable_math.hpp"

namespace adit {

/// What a series of random numbers is for; each has its own.
enum class RandomStream : uint64_t {
  scene,
  range,
  imu_noise,
  imu_bias,
  gnss,
  fault,
  change,
  wheels,
  doppler,
  odometry,
  heading
};

/// Random numbers that are functions of (seed, stream, index): whichever thread asks for number
/// `index`, in whatever order, gets the same one, on any machine.
class CounterRandom {
 public:
  CounterRandom(uint64_t seed, RandomStream stream)
      : key_(mixed(seed ^ mixed(static_cast<uint64_t>(stream) + 0x632be59bd9b4e019U))) {}

  uint64_t bits(uint64_t index) const {
    return mixed(key_ ^ mixed(index * 0x9e3779b97f4a7c15U + 0xd1b54a32d192ed03U));
  }

  /// Uniform in [0, 1).
  double uniform(uint64_t index) const { return static_cast<double>(bits(index) >> 11U) * 0x1p-53; }

  /// Two independent numbers of mean 0 and standard deviation 1 (Box and Muller's transform).
  Eigen::Vector2d gaussians(uint64_t index) const {
    const double radius = std::sqrt(-2.0 * repeatable_log(1.0 - uniform(2 * index)));
    const SinCos angle = repeatable_sin_cos(2.0 * std::numbers::pi * uniform(2 * index + 1));
    return {radius * angle.cos, radius * angle.sin};
  }

  /// Three of them, in the order of an axis each.
  Eigen::Vector3d gaussian_vector(uint64_t index) const {
    const Eigen::Vector2d first = gaussians(2 * index);
    return {first.x(), first.y(), gaussians(2 * index + 1).x()};
  }

 private:
  /// The finaliser of SplitMix64 (Steele, Lea and Flood 2014): each bit in turns half the bits out.
  static constexpr uint64_t mixed(uint64_t x) {
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
  }

  uint64_t key_;
};

}  // namespace adit
