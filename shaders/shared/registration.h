// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A batch of alignments on the device. Tangent vectors are [rho, phi] in the target's axes, the
// rotation about the source's own origin: R <- Exp(phi) R, t <- t + rho. The host turns results
// into the body frame (slam/registration/registration.hpp).
#ifndef ADIT_SHADERS_SHARED_REGISTRATION_H
#define ADIT_SHADERS_SHARED_REGISTRATION_H
#include "adit/shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

// Specialization constant kMethod.
const uint kVgicp = 0;         // voxelised GICP: point and voxel with regularised covariances
const uint kNdt = 1;           // point to Gaussian with Magnusson's score
const uint kPointToPlane = 2;  // point to the plane of its voxel
const uint kNdtToNdt = 3;      // Gaussian to Gaussian (D2D)

// Specialization constant kRobust: weight of a match of Mahalanobis distance d, u = d / width.
const uint kNoRobust = 0;
const uint kHuber = 1;         // min(1, 1 / u)
const uint kCauchy = 2;        // 1 / (1 + u^2)
const uint kGemanMcClure = 3;  // 1 / (1 + u^2)^2

// What an alignment waits for; each kernel passes over those that wait for another.
const uint kPhaseIterate = 0;      // a linearisation and its step
const uint kPhaseAssess = 1;       // the sums at the final pose
const uint kPhaseLocalize = 2;     // which directions the normals of its matches hold
const uint kPhaseConstrained = 3;  // steps with the prior
const uint kPhaseReassess = 4;     // as kPhaseAssess, after constrained steps
const uint kPhaseRelocalize = 5;
const uint kPhaseDone = 6;

// RegistrationState::constrained.
const uint kUnconstrained = 0;  // the result is the matches' alone
const uint kWithoutWeak = 1;    // weak directions were taken out, and the prior decides there
const uint kWithPrior = 2;      // the prior and the matches weigh by their information

// The largest factor of a step (registration_step.glsl).
const float kLongest = 2.0f;

// Sums of one linearisation: 21 of H (upper triangle, row by row), 6 of the gradient, the cost, the
// squared distance along the target's normals (m^2), the points matched, the matches.
const uint kSystemSize = 31;
const uint kCostAt = 27;
const uint kSquaredAt = 28;
const uint kInliersAt = 29;
const uint kMatchesAt = 30;
// And where the geometry is assessed: the weights w, w ra (3), w ra ra^T (6), w e (3), w ra x e
// (3).
const uint kGeometryAt = 31;
const uint kGeometrySize = 47;
const uint kSystemStride = 48;

// One alignment: what does not change while it runs. Offsets are in uvec4 of the bound slices.
struct RegistrationJob {
  uint source_begin;
  uint source_count;  // points; for kNdtToNdt slots of the source's voxel table
  uint target_begin;
  uint table_mask;     // slots of the target's table - 1
  uint groups;         // that share the source
  float cell;          // edge of the target's voxels, m
  float inverse_cell;  // 1/m
  float max_squared;   // d_max^2, m^2
  float wide_squared;  // the same for the first wide_iterations, m^2
  uint wide_iterations;
  float score_weight;    // d1 d2 of the NDT score; 1 for other methods
  float score_exponent;  // d2 / 2 of the NDT score, else 0
  vec3 viewpoint;        // position of the target's sensor, target frame, m
  uint unused0;
};

// How far an alignment is. The host's copy starts it.
struct RegistrationProgress {
  uint phase;
  uint iterations;
  uint converged;      // 1: the last step was short enough
  uint failed;         // 1: no finite step, or fewer than 6 matches
  uint ticket;         // groups that have finished the current pass
  float factor;        // length factor of the last step taken
  float most_factor;   // bound for the next; less than 1 where steps went to and fro
  float last_step[6];  // Gauss-Newton's, in units of 1 / sqrt(H_ii); zero: none yet
};

// Indirect arguments of one kind of pass, and how many alignments still need it.
struct RegistrationPass {
  uint groups_x, groups_y, groups_z;
  uint remaining;
};

// Before the progress of all alignments of the batch.
struct RegistrationHeader {
  RegistrationPass iterate;
  RegistrationPass assess;
  RegistrationPass constrained;
  RegistrationPass reassess;
};

struct RegistrationState {
  mat3x4 pose;         // T_target_source, rows: the initial guess, then the result
  mat3x4 guess;        // the initial guess, and the mean of the prior
  float prior[24];     // its information, 21 numbers as H; zero: none
  float system[48];    // sums at the pose
  vec4 directions[6];  // eigenvectors of the information on translation, then on rotation,
                       // ascending, with their eigenvalues (1/m^2, 1/rad^2)
  vec2 support[6];   // per direction: by matches with agreeing normals; information a match, 1/m^2
  float share[6];    // share of its information that a direction keeps: 0 none, 1 full
  uint constrained;  // kUnconstrained, kWithoutWeak or kWithPrior
  uint unused0;
};

struct RegistrationPush {
  float epsilon;              // the plane regularisation's small eigenvalue
  float fictitious;           // information that a match claims in every direction: 1/2 for kVgicp
  float robust_width;         // width of the robust kernel
  float translation_epsilon;  // m
  float rotation_epsilon;     // rad
  uint max_iterations;
  uint group_stride;  // groups of the largest job
  float weak_share;   // a direction with less of its information is taken out
  uint serves;        // the phase of the alignments that this pass is for
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
