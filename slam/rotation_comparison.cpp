// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/rotation_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include "slam/gyroscope_integral.hpp"
#include "slam/lie.hpp"
#include "slam/nav_state.hpp"

namespace adit {
namespace {

constexpr std::size_t kLeastIntervals = 20;
constexpr double kLeastCorrelation = 0.8;
constexpr double kGridStep = 0.01;   // s
constexpr double kUnobserved = 4.0;  // times the noise: less motion about an axis tells nothing

/// An interval in seconds from the first one's begin.
struct Turn {
  double begin = 0.0;
  double end = 0.0;
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
};

/// The sums over all intervals at one offset, means taken off: a gyroscope's bias is in its mean.
struct Moments {
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();  ///< sum of (range)(gyroscope)^T
  Eigen::Matrix3d gyroscope = Eigen::Matrix3d::Zero();
  double range_energy = 0.0;
  double gyroscope_energy = 0.0;
};

Moments moments_at(double offset, std::span<const Turn> turns, const GyroscopeIntegral& integral) {
  std::vector<Eigen::Vector3d> measured;
  measured.reserve(turns.size());
  Eigen::Vector3d range_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyroscope_mean = Eigen::Vector3d::Zero();
  for (const Turn& turn : turns) {
    measured.push_back(integral.at(turn.end + offset) - integral.at(turn.begin + offset));
    range_mean += turn.rotation;
    gyroscope_mean += measured.back();
  }
  const auto n = static_cast<double>(turns.size());
  range_mean /= n;
  gyroscope_mean /= n;
  Moments sums;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const Eigen::Vector3d range = turns[i].rotation - range_mean;
    const Eigen::Vector3d gyroscope = measured[i] - gyroscope_mean;
    sums.cross += range * gyroscope.transpose();
    sums.gyroscope += gyroscope * gyroscope.transpose();
    sums.range_energy += range.squaredNorm();
    sums.gyroscope_energy += gyroscope.squaredNorm();
  }
  return sums;
}

/// The rotation R that makes the trace of R^T M greatest (Wahba's problem).
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

/// The greatest trace that a rotation can make of it.
double explained(const Eigen::Matrix3d& cross) {
  return (nearest_rotation(cross).transpose() * cross).trace();
}

double correlation(const Moments& sums) {
  const double energy = std::sqrt(sums.range_energy * sums.gyroscope_energy);
  return energy > 0.0 ? explained(sums.cross) / energy : 0.0;
}

/// Where the correlation is greatest: first on a grid, then by thirds around the best of it.
double best_offset(std::span<const Turn> turns, const GyroscopeIntegral& integral, double most) {
  const auto value = [&](double offset) {
    return correlation(moments_at(offset, turns, integral));
  };
  double best = 0.0;
  double greatest = -std::numeric_limits<double>::infinity();
  const auto steps = static_cast<int>(std::floor(most / kGridStep));
  for (int i = -steps; i <= steps; ++i) {
    const double found = value(kGridStep * i);
    if (found > greatest) {
      greatest = found;
      best = kGridStep * i;
    }
  }
  double low = std::max(-most, best - kGridStep);
  double high = std::min(most, best + kGridStep);
  while (high - low > 1e-5) {
    const double third = (high - low) / 3.0;
    if (value(low + third) < value(high - third)) {
      low += third;
    } else {
      high -= third;
    }
  }
  return 0.5 * (low + high);
}

/// The intervals that are covered whatever the offset.
std::vector<Turn> covered_turns(std::span<const RotationInterval> rotations,
                                const GyroscopeIntegral& integral, double most_offset) {
  std::vector<Turn> turns;
  for (const RotationInterval& one : rotations) {
    const Turn turn{seconds(one.begin - rotations.front().begin),
                    seconds(one.end - rotations.front().begin), one.rotation};
    if (turn.end > turn.begin &&
        integral.covers(turn.begin - most_offset, turn.end + most_offset)) {
      turns.push_back(turn);
    }
  }
  return turns;
}

/// Mounting and its standard deviations; `noise` is the variance of a component of a rotation.
void find_mounting(const Moments& sums, double noise, std::size_t n,
                   const Eigen::Matrix3d& expected, RotationComparison& result) {
  const double prior = kUnobserved * static_cast<double>(n) * noise;
  // What the motion tells is not to be pulled to what is expected: that is replaced by the result.
  result.R_range_gyro = expected;
  for (int i = 0; i < 3; ++i) {
    result.R_range_gyro = nearest_rotation(sums.cross + prior * result.R_range_gyro);
  }
  result.misalignment = rotation_angle(expected.transpose() * result.R_range_gyro);
  // A turn about an axis is seen in the motion about the two others.
  const Eigen::Matrix3d motion =
      result.R_range_gyro * sums.gyroscope * result.R_range_gyro.transpose();
  const Eigen::Matrix3d information = motion.trace() * Eigen::Matrix3d::Identity() - motion;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(information);
  for (int i = 0; i < 3; ++i) {
    double variance = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double share = axes.eigenvectors()(i, k) * axes.eigenvectors()(i, k);
      if (axes.eigenvalues()(k) > prior) {
        variance += share * noise / axes.eigenvalues()(k);
      } else if (share > 0.1) {
        variance = std::numeric_limits<double>::infinity();
      }
    }
    result.mounting_sigma(i) = std::sqrt(variance);
  }
}

}  // namespace

std::optional<RotationComparison> compare_rotations(std::span<const RotationInterval> rotations,
                                                    std::span<const ImuSample> gyroscope,
                                                    const Eigen::Matrix3d& R_range_gyro_expected,
                                                    double most_offset) {
  if (rotations.empty()) {
    return std::nullopt;
  }
  const GyroscopeIntegral integral(gyroscope, rotations.front().begin);
  const std::vector<Turn> turns = covered_turns(rotations, integral, most_offset);
  if (turns.size() < kLeastIntervals) {
    return std::nullopt;
  }
  RotationComparison result;
  result.offset = best_offset(turns, integral, most_offset);
  const Moments sums = moments_at(result.offset, turns, integral);
  result.correlation = correlation(sums);
  if (!(result.correlation >= kLeastCorrelation)) {
    return std::nullopt;
  }
  const std::size_t n = turns.size();
  const double residual =
      std::max(0.0, sums.range_energy + sums.gyroscope_energy - 2.0 * explained(sums.cross));
  const double noise = residual / static_cast<double>(3 * n - 7);  // 3 bias, 3 mounting, 1 offset
  double change = 0.0;  // of all rotations with the offset, squared
  for (const Turn& turn : turns) {
    change += (integral.rate(turn.end + result.offset) - integral.rate(turn.begin + result.offset))
                  .squaredNorm();
  }
  result.offset_sigma = std::sqrt(noise / change);
  find_mounting(sums, noise, n, R_range_gyro_expected, result);
  return result;
}

double known_mounting_sigma(const RotationComparison& found) {
  double sigma = 0.0;
  for (const double one : found.mounting_sigma) {
    sigma = std::isfinite(one) ? std::max(sigma, one) : sigma;
  }
  return sigma;
}

std::string unobserved_axes(const RotationComparison& comparison) {
  constexpr std::array kNames = {"roll", "pitch", "yaw"};
  std::string text;
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(comparison.mounting_sigma(i))) {
      text += (text.empty() ? "" : ", ") + std::string(kNames[static_cast<size_t>(i)]);
    }
  }
  return text;
}

}  // namespace adit
