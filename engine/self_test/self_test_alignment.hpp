// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The alignment of the known cloud with its own map, by whatever method.
#pragma once

#include <cstdint>

#include "adit/shaders/shared/registration.h"

namespace adit::engine {

inline constexpr uint32_t kSlots = 4096;   // slots of the voxel map; about 150 voxels
inline constexpr double kVoxelSize = 0.5;  // m
inline constexpr uint64_t kProgressBytes =
    sizeof(gpu::RegistrationHeader) + sizeof(gpu::RegistrationProgress);

inline gpu::RegistrationState identity_state() {
  gpu::RegistrationState state{};
  state.pose = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  state.guess = state.pose;
  return state;
}

inline gpu::RegistrationJob known_job(uint32_t points, uint32_t groups) {
  gpu::RegistrationJob job{};
  job.source_count = points;
  job.table_mask = kSlots - 1;
  job.groups = groups;
  job.cell = static_cast<float>(kVoxelSize);
  job.inverse_cell = static_cast<float>(1.0 / kVoxelSize);
  job.max_squared = 0.25F;
  job.score_weight = 1.0F;
  return job;
}

}  // namespace adit::engine
