// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/repeatable_math.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

// pi/2 in three parts; the first two have trailing zeros, so that multiples of them are exact.
constexpr double kHalfPiHigh = 1.57079632673412561417e+00;
constexpr double kHalfPiMiddle = 6.07710050630396597660e-11;
constexpr double kHalfPiLow = 2.02226624879595063154e-21;

/// Taylor's series on [-pi/4, pi/4].
SinCos small_sin_cos(double x) {
  const double z = x * x;
  double sine = 1.0;
  double cosine = 1.0;
  for (int n = 9; n >= 1; --n) {
    const double k = 2.0 * n;
    sine = 1.0 - sine * z / (k * (k + 1.0));
    cosine = 1.0 - cosine * z / (k * (k - 1.0));
  }
  return {.sin = x * sine, .cos = cosine};
}

/// Arc tangent for |x| <= 1: halves the angle three times, then sums the series.
double small_atan(double x) {
  constexpr int kHalvings = 3;
  for (int i = 0; i < kHalvings; ++i) {
    x = x / (1.0 + std::sqrt(1.0 + x * x));
  }
  const double z = x * x;
  double sum = 0.0;
  for (int k = 19; k >= 1; k -= 2) {
    sum = 1.0 / k - z * sum;
  }
  return 8.0 * x * sum;
}

}  // namespace

SinCos repeatable_sin_cos(double angle) {
  const double quarter = std::floor(angle / (0.5 * kPi) + 0.5);
  const double rest =
      ((angle - quarter * kHalfPiHigh) - quarter * kHalfPiMiddle) - quarter * kHalfPiLow;
  const SinCos small = small_sin_cos(rest);
  switch (static_cast<int64_t>(quarter) & 3) {
    case 0:
      return small;
    case 1:
      return {.sin = small.cos, .cos = -small.sin};
    case 2:
      return {.sin = -small.sin, .cos = -small.cos};
    default:
      return {.sin = -small.cos, .cos = small.sin};
  }
}

double repeatable_atan2(double y, double x) {
  if (x == 0.0 && y == 0.0) {
    return 0.0;
  }
  if (std::abs(y) > std::abs(x)) {
    return (y > 0.0 ? 0.5 : -0.5) * kPi - small_atan(x / y);
  }
  const double angle = small_atan(y / x);
  return x > 0.0 ? angle : angle + (y < 0.0 ? -kPi : kPi);
}

double repeatable_log(double x) {
  const auto bits = std::bit_cast<uint64_t>(x);
  auto exponent = static_cast<int>(bits >> 52U) - 1023;
  double mantissa = std::bit_cast<double>((bits & 0x000fffffffffffffU) | 0x3ff0000000000000U);
  if (mantissa > std::numbers::sqrt2) {
    mantissa *= 0.5;
    ++exponent;
  }
  // log m = 2 artanh((m - 1) / (m + 1)).
  const double s = (mantissa - 1.0) / (mantissa + 1.0);
  const double z = s * s;
  double sum = 0.0;
  for (int k = 21; k >= 1; k -= 2) {
    sum = 1.0 / k + z * sum;
  }
  return 2.0 * s * sum + exponent * std::numbers::ln2;
}

double repeatable_exp(double x) {
  if (x < -700.0) {
    return 0.0;
  }
  const double power = std::floor(x / std::numbers::ln2 + 0.5);
  constexpr double kLn2High = 6.93147180369123816490e-01;
  constexpr double kLn2Low = 1.90821492927058770002e-10;
  const double rest = (x - power * kLn2High) - power * kLn2Low;
  double sum = 1.0;
  for (int n = 14; n >= 1; --n) {
    sum = 1.0 + sum * rest / n;
  }
  const auto exponent = static_cast<uint64_t>(static_cast<int64_t>(power) + 1023);
  return sum * std::bit_cast<double>(exponent << 52U);
}

Eigen::Matrix3d repeatable_so3_exp(const Eigen::Vector3d& phi) {
  const double square = phi.squaredNorm();
  double a = 1.0 - square / 6.0;
  double b = 0.5 - square / 24.0;
  if (square > 1e-10) {
    const double angle = std::sqrt(square);
    const SinCos half = repeatable_sin_cos(0.5 * angle);
    a = 2.0 * half.sin * half.cos / angle;
    b = 2.0 * half.sin * half.sin / square;
  }
  const Eigen::Matrix3d K = skew(phi);
  return Eigen::Matrix3d::Identity() + a * K + b * K * K;
}

Eigen::Vector3d repeatable_so3_log(const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d twice_sine_axis(rotation(2, 1) - rotation(1, 2),
                                        rotation(0, 2) - rotation(2, 0),
                                        rotation(1, 0) - rotation(0, 1));
  const double twice_sine = std::sqrt(twice_sine_axis.squaredNorm());
  if (twice_sine < 1e-7) {
    return 0.5 * twice_sine_axis;
  }
  const double angle = repeatable_atan2(twice_sine, rotation.trace() - 1.0);
  return angle / twice_sine * twice_sine_axis;
}

Eigen::Matrix3d rotation_from_yaw_pitch_roll(double yaw, double pitch, double roll) {
  return repeatable_so3_exp({0.0, 0.0, yaw}) * repeatable_so3_exp({0.0, pitch, 0.0}) *
         repeatable_so3_exp({roll, 0.0, 0.0});
}

}  // namespace adit
