// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Two sensors on one body turn alike. From the rotations of one and the rates of the other follow
// the offset of their clocks and how they are mounted to each other.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "adit/slam/core/types.hpp"

namespace adit {

/// What a sensor turned between two times.
struct RotationInterval {
  Nanoseconds begin{0};
  Nanoseconds end{0};
  /// rad, Log(R_world_begin^T R_world_end): in the sensor's axes
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  /// s. Where the attitudes are means over a sweep: how long it is, from `begin` and `end` on.
  double mean_over = 0.0;
};

/// The mean attitude of a sensor over a sweep: what aligning the sweep measures.
struct MeanAttitude {
  Nanoseconds stamp{0};  ///< of the sweep's start
  double span = 0.0;     ///< s, how long the sweep is; 0: taken as at once
  Eigen::Matrix3d R_world_sensor = Eigen::Matrix3d::Identity();
};

/// The turn from one sweep to a later one. None where they are not in order, or where their spans
/// differ by 10 ms or more: one of them lacks a part, and with it its mean.
std::optional<RotationInterval> turn_between(const MeanAttitude& from, const MeanAttitude& to);

struct RotationComparison {
  /// s. The same motion has later times at the gyroscope by this much (earlier if negative).
  double offset = 0.0;
  double offset_sigma = 0.0;  ///< s, standard deviation from the residuals
  double correlation = 0.0;   ///< correlation of the two at this offset, 0 to 1
  /// The gyroscope's turns over the range sensor's: 1 is right; standard deviation from the
  /// residuals.
  double scale = 1.0;
  double scale_sigma = 0.0;
  /// Nearest to the expected mounting in directions that the motion does not tell.
  Eigen::Matrix3d R_range_gyro = Eigen::Matrix3d::Identity();
  double misalignment = 0.0;  ///< rad, of the expected mounting, as far as the motion tells it
  /// rad, by which what fits best is turned farther, about axes that the motion does not tell.
  double hidden_turn = 0.0;
  /// rad, standard deviation of the mounting about the range sensor's three axes; infinite where
  /// the motion does not tell it.
  Eigen::Vector3d mounting_sigma = Eigen::Vector3d::Zero();
  /// 1/rad², eigenvalues of the mounting's information, offset and bias unknown, in ascending
  /// order.
  Eigen::Vector3d mounting_information = Eigen::Vector3d::Zero();
};

/// Fewer than this are not compared.
inline constexpr std::size_t kLeastRotations = 20;

/// Those that the samples cover with `most_offset` (s) to spare on both sides.
std::vector<RotationInterval> covered_rotations(std::span<const RotationInterval> rotations,
                                                std::span<const ImuSample> gyroscope,
                                                double most_offset);

/// Compares a range sensor's rotations (in the order of time) with a gyroscope's samples. Offsets
/// are searched up to `most_offset` (s); the gyroscope's bias and the mounting need not be known.
/// Intervals that the samples do not cover with that margin do not count. Nothing where fewer than
/// kLeastRotations remain, or where the rotations hold no common motion (correlation below 0.8).
std::optional<RotationComparison> compare_rotations(std::span<const RotationInterval> rotations,
                                                    std::span<const ImuSample> gyroscope,
                                                    const Eigen::Matrix3d& R_range_gyro_expected,
                                                    double most_offset);

/// How far the estimates of a comparison may be off: errors of neighbouring sweeps are alike, which
/// their residuals do not tell.
inline constexpr double kSureSigmas = 8.0;

/// The scale comes of all turns together, in which errors of neighbours cancel: it is sure within
/// fewer. Sweeps without times, and their drift, feign some per cent.
inline constexpr double kSureScaleSigmas = 4.0;
inline constexpr double kHarmlessScale = 0.04;
/// Sweeps that hardly agree with the gyroscope, as those of wild motions, tell no scale.
inline constexpr double kCorrelationForScale = 0.99;

/// The gyroscope's scale is off, for all that the sweeps can feign.
inline bool is_off_scale(const RotationComparison& comparison) {
  return comparison.correlation > kCorrelationForScale &&
         std::abs(comparison.scale - 1.0) >
             kHarmlessScale + kSureScaleSigmas * comparison.scale_sigma;
}

/// The mounting that was found can be relied on. Where the motion hides an axis, a sensor that is
/// far off (20 degrees) about any axis is not known: it may be so about that one, and what it seems
/// to be off about the others is then in wrong axes.
bool tells_mounting(const RotationComparison& comparison);

/// The greatest standard deviation (rad) of the mounting about an axis that the motion tells.
double known_mounting_sigma(const RotationComparison& comparison);

/// Roll, pitch and yaw about the lidar's axes: true where the motion does not tell the mounting.
std::array<bool, 3> unobserved_axes(const RotationComparison& comparison);

}  // namespace adit
