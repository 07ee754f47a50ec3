// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/rotation_comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/nav_state.hpp"
#include "adit/slam/inertial/rotation_fit.hpp"

namespace adit {
namespace {

constexpr double kLeastCorrelation = 0.8;
constexpr double kGridStep = 0.01;  // s
constexpr double kFarOff = 0.35;    // rad
constexpr double kSameSpan = 0.01;  // s

/// The sums over all intervals at one offset, means taken off: a gyroscope's bias is in its mean.
struct Moments {
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();  ///< sum of (range)(gyroscope)^T
  Eigen::Matrix3d gyroscope = Eigen::Matrix3d::Zero();
  double range_energy = 0.0;
  double gyroscope_energy = 0.0;
};

Moments moments_at(double offset, std::span<const MeasuredTurn> turns,
                   const GyroscopeIntegral& integral) {
  std::vector<Eigen::Vector3d> measured;
  measured.reserve(turns.size());
  Eigen::Vector3d range_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyroscope_mean = Eigen::Vector3d::Zero();
  for (const MeasuredTurn& turn : turns) {
    measured.push_back(integral.angle(turn.end + offset, turn.span) -
                       integral.angle(turn.begin + offset, turn.span));
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

/// Where on a grid the correlation is greatest.
double best_offset(std::span<const MeasuredTurn> turns, const GyroscopeIntegral& integral,
                   double most) {
  double best = 0.0;
  double greatest = -std::numeric_limits<double>::infinity();
  const auto steps = static_cast<int>(std::floor(most / kGridStep));
  for (int i = -steps; i <= steps; ++i) {
    const double found = correlation(moments_at(kGridStep * i, turns, integral));
    if (found > greatest) {
      greatest = found;
      best = kGridStep * i;
    }
  }
  return best;
}

/// In seconds from `origin`.
MeasuredTurn measured_turn(const RotationInterval& rotation, Nanoseconds origin) {
  return {.begin = seconds(rotation.begin - origin),
          .end = seconds(rotation.end - origin),
          .span = rotation.mean_over,
          .rotation = rotation.rotation};
}

bool is_covered(const MeasuredTurn& turn, const GyroscopeIntegral& integral, double most_offset) {
  return turn.end > turn.begin &&
         integral.covers(turn.begin - most_offset, turn.end + turn.span + most_offset);
}

/// The mounting that fits best; as expected in directions that the motion does not tell.
Eigen::Matrix3d first_mounting(const Moments& sums, double noise, std::size_t n,
                               const Eigen::Matrix3d& expected) {
  const double prior = kLeastInformation * static_cast<double>(n) * noise;
  return nearest_rotation(sums.cross + prior * expected);
}

/// The mounting of a fit, without its turn from the expected one about axes that the motion does
/// not tell: noise alone, and the start of the fit, decide about that.
Eigen::Matrix3d told_mounting(const RotationFit& fit, const Eigen::Matrix3d& expected) {
  if (std::ranges::none_of(fit.observable, std::identity())) {
    return expected;
  }
  Eigen::Quaterniond turn(fit.frame.R_range_gyro * expected.transpose());
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = fit.axes.col(k);
    Eigen::Quaterniond twist;
    twist.w() = turn.w();
    twist.vec() = axis * axis.dot(turn.vec());
    if (!fit.observable[static_cast<std::size_t>(k)] && twist.norm() > 0.0) {
      turn = twist.normalized().conjugate() * turn;
    }
  }
  return turn.normalized().toRotationMatrix() * expected;
}

/// About the range sensor's axes; infinite about those with a share in what is not observable.
Eigen::Vector3d mounting_sigma(const RotationFit& fit) {
  Eigen::Vector3d sigma;
  for (int i = 0; i < 3; ++i) {
    double variance = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double share = fit.axes(i, k) * fit.axes(i, k);
      if (fit.observable[static_cast<std::size_t>(k)]) {
        variance += share / fit.eigenvalues(k);
      } else if (share > 0.1) {
        variance = std::numeric_limits<double>::infinity();
      }
    }
    sigma(i) = std::sqrt(variance);
  }
  return sigma;
}

}  // namespace

std::optional<RotationInterval> turn_between(const MeanAttitude& from, const MeanAttitude& to) {
  if (to.stamp <= from.stamp || !(std::abs(to.span - from.span) < kSameSpan)) {
    return std::nullopt;
  }
  return RotationInterval{.begin = from.stamp,
                          .end = to.stamp,
                          .rotation = so3_log(from.R_world_sensor.transpose() * to.R_world_sensor),
                          .mean_over = 0.5 * (to.span + from.span)};
}

std::vector<RotationInterval> covered_rotations(std::span<const RotationInterval> rotations,
                                                std::span<const ImuSample> gyroscope,
                                                double most_offset) {
  const Nanoseconds origin = rotations.empty() ? Nanoseconds(0) : rotations.front().begin;
  const GyroscopeIntegral integral(gyroscope, origin);
  std::vector<RotationInterval> covered;
  std::ranges::copy_if(rotations, std::back_inserter(covered), [&](const RotationInterval& one) {
    return is_covered(measured_turn(one, origin), integral, most_offset);
  });
  return covered;
}

std::optional<RotationComparison> compare_rotations(std::span<const RotationInterval> rotations,
                                                    std::span<const ImuSample> gyroscope,
                                                    const Eigen::Matrix3d& R_range_gyro_expected,
                                                    double most_offset) {
  if (rotations.empty()) {
    return std::nullopt;
  }
  const GyroscopeIntegral integral(gyroscope, rotations.front().begin);
  std::vector<MeasuredTurn> turns;
  for (const RotationInterval& one : rotations) {
    const MeasuredTurn turn = measured_turn(one, rotations.front().begin);
    if (is_covered(turn, integral, most_offset)) {
      turns.push_back(turn);
    }
  }
  if (turns.size() < kLeastRotations) {
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
  const RotationFit fit =
      fit_rotations(turns, integral,
                    {.offset = result.offset,
                     .R_range_gyro = first_mounting(sums, noise, n, R_range_gyro_expected)},
                    most_offset);
  result.offset = fit.frame.offset;
  result.offset_sigma = fit.offset_sigma;
  result.R_range_gyro = told_mounting(fit, R_range_gyro_expected);
  // The range sensor's turns by the gyroscope's, which have the smaller errors.
  const Moments at_fit = moments_at(result.offset, turns, integral);
  const double slope =
      (result.R_range_gyro.transpose() * at_fit.cross).trace() / at_fit.gyroscope_energy;
  result.scale = 1.0 / slope;
  result.scale_sigma = std::sqrt(noise / at_fit.gyroscope_energy) / (slope * slope);
  result.misalignment = rotation_angle(R_range_gyro_expected.transpose() * result.R_range_gyro);
  result.hidden_turn = rotation_angle(result.R_range_gyro.transpose() * fit.frame.R_range_gyro);
  result.mounting_sigma = mounting_sigma(fit);
  result.mounting_information = fit.eigenvalues;
  return result;
}

bool tells_mounting(const RotationComparison& found) {
  return found.mounting_sigma.allFinite() ||
         std::max(found.misalignment, found.hidden_turn) < kFarOff;
}

double known_mounting_sigma(const RotationComparison& found) {
  double sigma = 0.0;
  for (const double one : found.mounting_sigma) {
    sigma = std::isfinite(one) ? std::max(sigma, one) : sigma;
  }
  return sigma;
}

std::array<bool, 3> unobserved_axes(const RotationComparison& comparison) {
  const Eigen::Vector3d& sigma = comparison.mounting_sigma;
  return {!std::isfinite(sigma.x()), !std::isfinite(sigma.y()), !std::isfinite(sigma.z())};
}

}  // namespace adit
