// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// State of one alignment on the device. Tangent vectors are [rho, phi] in map axes, the rotation
// about the source's own origin: R <- Exp(phi) R, t <- t + rho. The host turns H into the body
// frame (slam/lie.hpp).
#ifndef ADIT_SHADERS_SHARED_REGISTRATION_H
#define ADIT_SHADERS_SHARED_REGISTRATION_H
#include "shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

// Sums of one linearisation: 21 of H (upper triangle, row by row), 6 of the gradient, the cost, the
// squared distance along the target's normals (m^2), the number of matches.
const uint kSystemSize = 30;
const uint kSystemStride = 32;

// RegistrationState::phase
const uint kPhaseIterate = 0;   // the next linearisation ends in a step
const uint kPhaseEvaluate = 1;  // the next linearisation is the one to report
const uint kPhaseDone = 2;

struct RegistrationState {
  uint groups_x, groups_y,
      groups_z;  // indirect arguments of the next linearisation; zero once done
  uint phase;
  uint iterations;
  uint converged;      // 1: the last step was short enough
  uint failed;         // 1: no finite step, or fewer than 6 matches
  uint ticket;         // groups that have finished the current linearisation
  float damping;       // factor of the steps; halved where they go to and fro
  float last_step[6];  // in units of 1 / sqrt(H_ii)
  uint unused0;
  mat3x4 pose;  // T_target_source, rows
  float system[32];
};

// The part of the state that starts a level: everything before the pose.
struct RegistrationStart {
  uint groups_x, groups_y, groups_z;
  uint phase;
  uint iterations;
  uint converged;
  uint failed;
  uint ticket;
  float damping;
  float last_step[6];
  uint unused0;
};

struct LinearizePush {
  float cell;          // r_align, m
  float inverse_cell;  // 1/m
  uint table_mask;
  float max_squared;          // d_max^2, m^2
  float epsilon;              // the plane regularisation's small eigenvalue
  float translation_epsilon;  // m
  float rotation_epsilon;     // rad
  uint max_iterations;
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
