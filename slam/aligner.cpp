// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/aligner.hpp"

#include <array>
#include <cstddef>

#include "engine/context.hpp"
#include "shaders/shared/registration.h"

namespace adit {
namespace {

// Voxel sizes of the search, in multiples of r_align. From 16, a first motion of several metres is
// found (docs/theory/registration.md).
constexpr std::array kCoarseFactors = {16.0, 8.0, 4.0, 2.0};
constexpr engine::VgicpSettings kCoarseSettings = {
    .d_max = 0.0, .translation_epsilon = 5e-3, .rotation_epsilon = 1e-3, .max_iterations = 15};

constexpr uint64_t kPoseAt = engine::align_slice(sizeof(gpu::RegistrationStart));
constexpr uint64_t kStateStride = engine::align_slice(sizeof(gpu::RegistrationState));
constexpr uint64_t kMapCountersAt = 2 * kStateStride;

// The alignment from an untrusted prediction must match this many times as many points as the
// search's to be believed instead. A sensor at rest sees its own scan pattern again, so that no
// motion matches nearly as many as the true one; a search that went astray matches far fewer.
constexpr double kClearlyMore = 1.1;

const RegistrationResult& better(const RegistrationResult& predicted,
                                 const RegistrationResult& searched) {
  if (searched.status != RegistrationStatus::converged) {
    return predicted;
  }
  const bool clearly = predicted.inliers > kClearlyMore * searched.inliers;
  return predicted.status == RegistrationStatus::converged && clearly ? predicted : searched;
}

}  // namespace

Aligner::Aligner(engine::Context& context, const RegistrationConfig& config)
    : config_(config),
      vgicp_(context),
      upload_(context.make_buffer(kPoseAt + sizeof(gpu::mat3x4), engine::Memory::upload,
                                  "initial pose")),
      states_(context.make_buffer(2 * kStateStride, engine::Memory::device, "alignment")),
      scratch_(
          context.make_buffer(vgicp_.scratch_bytes(), engine::Memory::device, "alignment scratch")),
      readback_(context.make_buffer(kMapCountersAt + sizeof(gpu::VoxelMapCounters),
                                    engine::Memory::readback, "alignment back")) {
  upload_.as<gpu::RegistrationStart>()[0] = vgicp_.start();
}

void Aligner::record(engine::Recorder& recorder, const Prediction& prediction,
                     engine::Slice surface_cloud, engine::Slice counters, Submap& submap) {
  *reinterpret_cast<gpu::mat3x4*>(upload_.mapped() + kPoseAt) =
      to_device(submap.pose().inverse() * prediction.T_map_lidar);
  searched_ = !prediction.trusted;
  const engine::Slice all = states_;
  for (uint64_t at = 0; at < (searched_ ? 2 : 1) * kStateStride; at += kStateStride) {
    recorder.copy(upload_.slice(kPoseAt, sizeof(gpu::mat3x4)),
                  all.sub(at + offsetof(gpu::RegistrationState, pose), sizeof(gpu::mat3x4)));
  }
  engine::VgicpArguments arguments{.surface_cloud = surface_cloud,
                                   .counters = counters,
                                   .target = submap.voxel_map(),
                                   .start = upload_,
                                   .state = all.sub(0, sizeof(gpu::RegistrationState))};
  record_fine(recorder, arguments);
  if (searched_) {
    arguments.state = all.sub(kStateStride, sizeof(gpu::RegistrationState));
    record_search(recorder, arguments, submap);
    record_fine(recorder, arguments);
  }
  recorder.copy(states_, readback_.slice(0, 2 * kStateStride));
  recorder.copy(submap.voxel_map().counters,
                readback_.slice(kMapCountersAt, sizeof(gpu::VoxelMapCounters)));
}

void Aligner::record_search(engine::Recorder& recorder, engine::VgicpArguments arguments,
                            Submap& submap) {
  for (const double factor : kCoarseFactors) {
    arguments.target = submap.record_coarse(recorder, factor);
    engine::VgicpSettings settings = kCoarseSettings;
    settings.d_max = arguments.target.voxel_size;
    const engine::Scope scope = recorder.scope("coarse alignment");
    vgicp_.record(recorder, settings, arguments, scratch_);
  }
}

void Aligner::record_fine(engine::Recorder& recorder, const engine::VgicpArguments& arguments) {
  const engine::Scope scope = recorder.scope("alignment");
  vgicp_.record(recorder,
                {.d_max = config_.d_max,
                 .translation_epsilon = config_.translation_epsilon,
                 .rotation_epsilon = config_.rotation_epsilon,
                 .max_iterations = static_cast<uint32_t>(config_.max_iterations)},
                arguments, scratch_);
}

RegistrationResult Aligner::read_result(int source_points, const Submap& submap) const {
  const auto read = [&](uint64_t at) {
    return read_registration(
        *reinterpret_cast<const gpu::RegistrationState*>(readback_.mapped() + at), source_points,
        config_);
  };
  RegistrationResult result = searched_ ? better(read(0), read(kStateStride)) : read(0);
  result.T_target_source = orthonormalized(submap.pose() * result.T_target_source);
  return result;
}

gpu::VoxelMapCounters Aligner::read_map_counters() const {
  return *reinterpret_cast<const gpu::VoxelMapCounters*>(readback_.mapped() + kMapCountersAt);
}

}  // namespace adit
