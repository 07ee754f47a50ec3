// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/nav_state.hpp"

namespace adit {

NavState retract(const NavState& state, const StateVector& delta) {
  NavState moved = state;
  moved.T_map_body = retract(state.T_map_body, Vector6d(delta.head<6>()));
  moved.v_map_body += delta.segment<3>(kVelocityAt);
  moved.bias.gyro += delta.segment<3>(kGyroBiasAt);
  moved.bias.accel += delta.segment<3>(kAccelBiasAt);
  moved.gravity_map = turned(state.gravity_map, delta.segment<2>(kGravityAt));
  moved.velocity.scale += delta[kScaleAt];
  moved.velocity.turn += delta.segment<2>(kTurnAt);
  return moved;
}

StateVector difference(const NavState& from, const NavState& to) {
  const Eigen::Matrix3d R_body_map = from.T_map_body.linear().transpose();
  StateVector delta;
  delta << R_body_map * (to.T_map_body.translation() - from.T_map_body.translation()),
      so3_log(R_body_map * to.T_map_body.linear()), to.v_map_body - from.v_map_body,
      to.bias.gyro - from.bias.gyro, to.bias.accel - from.bias.accel,
      turn_between(from.gravity_map, to.gravity_map), to.velocity.scale - from.velocity.scale,
      to.velocity.turn - from.velocity.turn;
  return delta;
}

}  // namespace adit
