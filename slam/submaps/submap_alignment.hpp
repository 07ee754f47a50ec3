// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/core/config.hpp"
#include "adit/slam/registration/batch_aligner.hpp"

namespace adit {

/// How two submaps are aligned: limits are those of sweeps. Consecutive ones by the method that is
/// set; those of a loop by VGICP, which knows what its matches do not hold.
inline AlignmentSettings submap_alignment_settings(const Config& config,
                                                   RegistrationMethod method) {
  const RegistrationConfig& registration = config.registration;
  const bool ndt = method == RegistrationMethod::ndt;
  return {.method = method,
          .neighbours = ndt ? 7 : 1,
          .robust = ndt ? RobustKernel::none : RobustKernel::cauchy,
          .d_max = registration.d_max,
          .max_iterations = registration.max_iterations,
          .translation_epsilon = registration.translation_epsilon,
          .rotation_epsilon = registration.rotation_epsilon,
          .min_inliers = registration.min_inliers,
          .min_overlap = registration.min_overlap};
}

}  // namespace adit
