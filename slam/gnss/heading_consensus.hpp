// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The yaw of a map that most headings agree with (docs/theory/gnss.md).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace adit {

/// Chi squared of one direction, 99 %: a heading beyond it is an outlier.
inline constexpr double kHeadingGate = 6.63;
/// Standard deviation of the yaw that the odometry's drift and the map's shape add, rad: the 1 % of
/// the distance that fixes are allowed, too.
inline constexpr double kMapYaw = 0.01;
/// Fewer headings are no evidence.
inline constexpr std::size_t kFewestHeadings = 5;

/// Within half a turn of 0, rad.
double wrapped_angle(double angle);

/// What one heading says that the map's yaw is.
struct YawSample {
  double yaw = 0.0;    ///< rad
  double sigma = 0.0;  ///< rad
  double share = 1.0;  ///< as how many independent ones it counts
};

struct YawConsensus {
  double yaw = 0.0;          ///< rad, weighted mean of those that agree
  double sigma = 0.0;        ///< rad, of the mean, without what they have in common
  std::vector<bool> agrees;  ///< each sample, within its error and kMapYaw
  std::size_t agreeing = 0;
};

/// The yaw that most samples agree with, among those of the samples themselves (100 at the most,
/// evenly spread), then the mean of those that agree. None: there are fewer than kFewestHeadings.
std::optional<YawConsensus> yaw_consensus(std::span<const YawSample> samples);

}  // namespace adit
