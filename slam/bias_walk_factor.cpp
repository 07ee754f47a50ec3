// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/bias_walk_factor.hpp"

#include <cmath>

namespace adit {

LinkFactor<6> bias_walk_factor(const ImuNoise& noise, double duration, const NavState& from,
                               const NavState& to) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(noise.gyro_walk), Eigen::Vector3d::Constant(noise.accel_walk);
  const Vector6d weight = (std::sqrt(duration) * sigma).cwiseInverse();
  Vector6d change;
  change << to.bias.gyro - from.bias.gyro, to.bias.accel - from.bias.accel;
  LinkFactor<6> factor;
  factor.residual = weight.cwiseProduct(change);
  factor.by_to.middleCols<6>(kGyroBiasAt) = weight.asDiagonal();
  factor.by_from.middleCols<6>(kGyroBiasAt) = -factor.by_to.middleCols<6>(kGyroBiasAt);
  return factor;
}

}  // namespace adit
