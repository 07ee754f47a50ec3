// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace adit {

/// Random numbers that are the same with every standard library: the engine's sequence is fixed by
/// the standard, that of the standard distributions is not.
class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}

  /// Uniform in [low, high).
  double uniform(double low, double high) {
    constexpr double kStep = 0x1p-53;
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * kStep;
  }

  /// Mean 0, standard deviation 1 (Box and Muller's transform; the second number of a pair is
  /// dropped).
  double gaussian() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
    return radius * std::cos(uniform(0.0, 2.0 * std::numbers::pi));
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace adit
