// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/aligner.hpp"

#include <array>
#include <cstddef>

#include "engine/context.hpp"
#include "shaders/shared/preprocess.h"
#include "shaders/shared/registration.h"
#include "slam/front_end.hpp"

namespace adit {
namespace {

// Voxel sizes of the search, in multiples of r_align. From 16, a first motion of several metres is
// found (docs/theory/registration.md).
constexpr std::array kCoarseFactors = {16.0, 8.0, 4.0, 2.0};
constexpr engine::RegistrationSettings kCoarseSettings = {
    .translation_epsilon = 5e-3,
    .rotation_epsilon = 1e-3,
    .max_iterations = 15,
    .robust_width = 1e3};  // far from everything else: no kernel

// Levels, and their places in the buffers: 0 is the fine one.
constexpr size_t kLevels = 1 + kCoarseFactors.size();
constexpr uint64_t kJobStride = engine::align_slice(sizeof(gpu::RegistrationJob));
constexpr uint64_t kStartAt = kLevels * kJobStride;
constexpr uint64_t kProgressBytes =
    sizeof(gpu::RegistrationHeader) + sizeof(gpu::RegistrationProgress);
constexpr uint64_t kProgressStride = engine::align_slice(kProgressBytes);
constexpr uint64_t kStateAt = kStartAt + kProgressStride;
constexpr uint64_t kStateStride = engine::align_slice(sizeof(gpu::RegistrationState));
// In the readback.
constexpr uint64_t kProgressBackAt = 2 * kStateStride;
constexpr uint64_t kMapCountersAt = kProgressBackAt + 2 * kProgressStride;

// Cauchy's kernel halves the weight of a match this far off, in standard deviations of its
// covariance: 4.5 cm along the normal where both are planes.
constexpr double kRobustWidth = 1.0;
constexpr double kFictitious = 0.5;  // information of a VGICP match in every direction

// The alignment from an untrusted prediction must match this many times as many points as the
// search's to be believed instead. A sensor at rest sees its own scan pattern again, so that no
// motion matches nearly as many as the true one; a search that went astray matches far fewer.
constexpr double kClearlyMore = 1.1;

const RegistrationResult& better(const RegistrationResult& predicted,
                                 const RegistrationResult& searched) {
  if (!is_usable(searched.status)) {
    return predicted;
  }
  const bool clearly = predicted.inliers > kClearlyMore * searched.inliers;
  return is_usable(predicted.status) && clearly ? predicted : searched;
}

}  // namespace

Aligner::Aligner(engine::Context& context, const RegistrationConfig& config)
    : config_(config),
      kernels_(context, {.robust = gpu::kCauchy}),
      upload_(context.make_buffer(kStateAt + sizeof(gpu::RegistrationState), engine::Memory::upload,
                                  "alignment start")),
      jobs_(context.make_buffer(kLevels * kJobStride, engine::Memory::device, "alignment jobs")),
      progress_(
          context.make_buffer(2 * kProgressStride, engine::Memory::device, "alignment progress")),
      states_(context.make_buffer(2 * kStateStride, engine::Memory::device, "alignment")),
      scratch_(context.make_buffer(kernels_.scratch_bytes(1, kernels_.groups(kLargestSweep)),
                                   engine::Memory::device, "alignment scratch")),
      readback_(context.make_buffer(kMapCountersAt + sizeof(gpu::VoxelMapCounters),
                                    engine::Memory::readback, "alignment back")) {}

void Aligner::record(engine::Recorder& recorder, const Prediction& prediction,
                     engine::Slice surface_cloud, engine::Slice counters, uint32_t most_points,
                     Submap& submap) {
  groups_ = kernels_.groups(most_points);
  engine::RegistrationKernels::write_start({upload_.mapped() + kStartAt, kProgressBytes}, 1,
                                           groups_);
  auto& state = *reinterpret_cast<gpu::RegistrationState*>(upload_.mapped() + kStateAt);
  state = initial_state(submap.pose().inverse() * prediction.T_map_lidar,
                        prediction.sigma.cwiseAbs2().cwiseInverse().asDiagonal());
  searched_ = !prediction.trusted;
  for (uint64_t at = 0; at < (searched_ ? 2 : 1) * kStateStride; at += kStateStride) {
    recorder.copy(upload_.slice(kStateAt, sizeof(gpu::RegistrationState)),
                  states_.slice(at, sizeof(gpu::RegistrationState)));
  }
  record_job(recorder, 0, submap.voxel_map(), config_.d_max, counters);
  record_fine(recorder, arguments(0, 0, surface_cloud, submap.voxel_map()), prediction.trusted);
  if (searched_) {
    record_search(recorder, surface_cloud, counters, submap);
    record_fine(recorder, arguments(1, 0, surface_cloud, submap.voxel_map()), false);
  }
  recorder.copy(states_, readback_.slice(0, 2 * kStateStride));
  recorder.copy(progress_, readback_.slice(kProgressBackAt, 2 * kProgressStride));
  recorder.copy(submap.voxel_map().counters,
                readback_.slice(kMapCountersAt, sizeof(gpu::VoxelMapCounters)));
}

// The job of a level: from the host, but for the number of points.
void Aligner::record_job(engine::Recorder& recorder, size_t level,
                         const engine::VoxelMapView& target, double d_max, engine::Slice counters) {
  *reinterpret_cast<gpu::RegistrationJob*>(upload_.mapped() + level * kJobStride) = {
      .source_begin = 0,
      .source_count = 0,
      .target_begin = 0,
      .table_mask = target.slots() - 1,
      .groups = groups_,
      .cell = static_cast<float>(target.voxel_size),
      .inverse_cell = static_cast<float>(1.0 / target.voxel_size),
      .max_squared = static_cast<float>(d_max * d_max),
      .wide_squared = 0.0F,
      .wide_iterations = 0,
      .score_weight = 1.0F,
      .score_exponent = 0.0F,
      .viewpoint = {},
      .unused0 = 0};
  const uint64_t at = level * kJobStride;
  const engine::Slice job = jobs_.slice(at, sizeof(gpu::RegistrationJob));
  recorder.copy(upload_.slice(at, sizeof(gpu::RegistrationJob)), job);
  recorder.barrier();
  recorder.copy(counters.sub(offsetof(gpu::SweepCounters, cloud_points), sizeof(uint32_t)),
                job.sub(offsetof(gpu::RegistrationJob, source_count), sizeof(uint32_t)));
}

engine::RegistrationArguments Aligner::arguments(size_t alignment, size_t level,
                                                 engine::Slice surface_cloud,
                                                 const engine::VoxelMapView& target) const {
  return {.count = 1,
          .group_stride = groups_,
          .source = surface_cloud,
          .target = target.table,
          .jobs = jobs_.slice(level * kJobStride, sizeof(gpu::RegistrationJob)),
          .start = upload_.slice(kStartAt, kProgressBytes),
          .progress = progress_.slice(alignment * kProgressStride, kProgressBytes),
          .states = states_.slice(alignment * kStateStride, sizeof(gpu::RegistrationState))};
}

void Aligner::record_search(engine::Recorder& recorder, engine::Slice surface_cloud,
                            engine::Slice counters, Submap& submap) {
  for (size_t level = 1; level < kLevels; ++level) {
    const engine::VoxelMapView target = submap.record_coarse(recorder, kCoarseFactors[level - 1]);
    record_job(recorder, level, target, target.voxel_size, counters);
    const engine::Scope scope = recorder.scope("coarse alignment");
    kernels_.record_steps(recorder, kCoarseSettings, arguments(1, level, surface_cloud, target),
                          scratch_);
  }
}

void Aligner::record_fine(engine::Recorder& recorder,
                          const engine::RegistrationArguments& arguments, bool trusted) {
  const engine::RegistrationSettings settings{
      .translation_epsilon = config_.translation_epsilon,
      .rotation_epsilon = config_.rotation_epsilon,
      .max_iterations = static_cast<uint32_t>(config_.max_iterations),
      .max_constrained = trusted ? static_cast<uint32_t>(config_.max_iterations) : 0,
      .weak_share = 0.0,  // a constant velocity knows less than a few matches
      .robust_width = kRobustWidth};
  {
    const engine::Scope scope = recorder.scope("alignment");
    kernels_.record_steps(recorder, settings, arguments, scratch_);
  }
  const engine::Scope scope = recorder.scope("assessment");
  kernels_.record_assessment(recorder, settings, arguments, scratch_);
}

RegistrationResult Aligner::read_result(int source_points, const Submap& submap) const {
  const auto read = [&](size_t alignment) {
    const std::byte* states = readback_.mapped() + alignment * kStateStride;
    const std::byte* progress = readback_.mapped() + kProgressBackAt + alignment * kProgressStride +
                                sizeof(gpu::RegistrationHeader);
    return read_registration({*reinterpret_cast<const gpu::RegistrationState*>(states),
                              *reinterpret_cast<const gpu::RegistrationProgress*>(progress)},
                             source_points, kFictitious, config_);
  };
  RegistrationResult result = searched_ ? better(read(0), read(1)) : read(0);
  result.T_target_source = orthonormalized(submap.pose() * result.T_target_source);
  return result;
}

gpu::VoxelMapCounters Aligner::read_map_counters() const {
  return *reinterpret_cast<const gpu::VoxelMapCounters*>(readback_.mapped() + kMapCountersAt);
}

}  // namespace adit
