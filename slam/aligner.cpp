// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/aligner.hpp"

#include <array>
#include <cstddef>

#include "engine/context.hpp"
#include "shaders/shared/registration.h"

namespace adit {
namespace {

// Voxel sizes of the search, in multiples of r_align. From 16, a first motion of several metres is found
// (docs/theory/registration.md).
constexpr std::array kCoarseFactors = {16.0, 8.0, 4.0, 2.0};
constexpr engine::VgicpSettings kCoarseSettings = {
    .d_max = 0.0, .translation_epsilon = 5e-3, .rotation_epsilon = 1e-3, .max_iterations = 15};

constexpr uint64_t kPoseAt = engine::align_slice(sizeof(gpu::RegistrationStart));
constexpr uint64_t kMapCountersAt = engine::align_slice(sizeof(gpu::RegistrationState));

}  // namespace

Aligner::Aligner(engine::Context& context, const RegistrationConfig& config)
    : config_(config),
      vgicp_(context),
      upload_(context.make_buffer(kPoseAt + sizeof(gpu::mat3x4), engine::Memory::upload, "initial pose")),
      state_(context.make_buffer(sizeof(gpu::RegistrationState), engine::Memory::device, "alignment")),
      scratch_(context.make_buffer(vgicp_.scratch_bytes(), engine::Memory::device, "alignment scratch")),
      readback_(context.make_buffer(kMapCountersAt + sizeof(gpu::VoxelMapCounters), engine::Memory::readback,
                                    "alignment back")) {
  upload_.as<gpu::RegistrationStart>()[0] = vgicp_.start();
}

void Aligner::record(engine::Recorder& recorder, const Prediction& prediction, engine::Slice surface_cloud,
                     engine::Slice counters, Submap& submap) {
  *reinterpret_cast<gpu::mat3x4*>(upload_.mapped() + kPoseAt) =
      to_device(submap.pose().inverse() * prediction.T_map_lidar);
  recorder.copy(upload_.slice(kPoseAt, sizeof(gpu::mat3x4)),
                state_.slice(offsetof(gpu::RegistrationState, pose), sizeof(gpu::mat3x4)));
  engine::VgicpArguments arguments{.surface_cloud = surface_cloud,
                                   .counters = counters,
                                   .target = submap.voxel_map(),
                                   .start = upload_,
                                   .state = state_};
  if (!prediction.trusted) {
    for (const double factor : kCoarseFactors) {
      arguments.target = submap.record_coarse(recorder, factor);
      engine::VgicpSettings settings = kCoarseSettings;
      settings.d_max = arguments.target.voxel_size;
      const engine::Scope scope = recorder.scope("coarse alignment");
      vgicp_.record(recorder, settings, arguments, scratch_);
    }
    arguments.target = submap.voxel_map();
  }
  {
    const engine::Scope scope = recorder.scope("alignment");
    vgicp_.record(recorder,
                  {.d_max = config_.d_max,
                   .translation_epsilon = config_.translation_epsilon,
                   .rotation_epsilon = config_.rotation_epsilon,
                   .max_iterations = static_cast<uint32_t>(config_.max_iterations)},
                  arguments, scratch_);
  }
  recorder.copy(state_, readback_.slice(0, sizeof(gpu::RegistrationState)));
  recorder.copy(submap.voxel_map().counters, readback_.slice(kMapCountersAt, sizeof(gpu::VoxelMapCounters)));
}

RegistrationResult Aligner::read_result(int source_points, const Submap& submap) const {
  RegistrationResult result =
      read_registration(readback_.as<gpu::RegistrationState>()[0], source_points, config_);
  result.T_target_source = orthonormalized(submap.pose() * result.T_target_source);
  return result;
}

gpu::VoxelMapCounters Aligner::read_map_counters() const {
  return *reinterpret_cast<const gpu::VoxelMapCounters*>(readback_.mapped() + kMapCountersAt);
}

}  // namespace adit
