// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/core/config.hpp"
#include "adit/slam/registration/batch_aligner.hpp"

namespace adit {

/// How two submaps are aligned, consecutive ones and those of a loop: limits are those of sweeps.
inline AlignmentSettings submap_alignment_settings(const Config& config) {
  const RegistrationConfig& registration = config.registration;
  return {.method = RegistrationMethod::vgicp,
          .neighbours = 1,
          .robust = RobustKernel::cauchy,
          .d_max = registration.d_max,
          .max_iterations = registration.max_iterations,
          .translation_epsilon = registration.translation_epsilon,
          .rotation_epsilon = registration.rotation_epsilon,
          .min_inliers = registration.min_inliers,
          .min_overlap = registration.min_overlap};
}

}  // namespace adit
