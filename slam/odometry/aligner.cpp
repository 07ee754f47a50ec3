// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/aligner.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "adit/engine/context.hpp"
#include "adit/shaders/shared/preprocess.h"
#include "adit/shaders/shared/registration.h"
#include "adit/slam/odometry/search_places.hpp"
#include "adit/slam/registration/front_end.hpp"

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

constexpr uint32_t kMostStarts = kMostPlaces;

// Steps that most alignments end within.
constexpr uint32_t kFewSteps = 8;

// Levels, and their places in the buffers: 0 is the fine one. Each has a job for every start.
constexpr size_t kLevels = 1 + kCoarseFactors.size();
constexpr uint64_t kJobStride = engine::align_slice(kMostStarts * sizeof(gpu::RegistrationJob));
constexpr uint64_t progress_bytes(uint32_t count) {
  return sizeof(gpu::RegistrationHeader) + count * sizeof(gpu::RegistrationProgress);
}
constexpr uint64_t state_bytes(uint32_t count) {
  return count * sizeof(gpu::RegistrationState);
}
// Progress of the alignment from the prediction; that of the search follows.
constexpr uint64_t kProgressStride = engine::align_slice(progress_bytes(1));
constexpr uint64_t kProgressBytes = kProgressStride + progress_bytes(kMostStarts);
constexpr uint64_t kStateStride = engine::align_slice(state_bytes(1));
constexpr uint64_t kStateBytes = kStateStride + state_bytes(kMostStarts);
// In the upload.
constexpr uint64_t kStartAt = kLevels * kJobStride;
constexpr uint64_t kStateAt = kStartAt + engine::align_slice(kProgressBytes);
// In the readback.
constexpr uint64_t kProgressBackAt = engine::align_slice(kStateBytes);
constexpr uint64_t kMapCountersAt = kProgressBackAt + engine::align_slice(kProgressBytes);

// Cauchy's kernel halves the weight of a match this far off, in standard deviations of its
// covariance: 4.5 cm along the normal where both are planes.
constexpr double kRobustWidth = 1.0;
constexpr double kFictitious = 0.5;  // information of a VGICP match in every direction

engine::RegistrationOptions options_of(RegistrationMethod method) {
  if (method == RegistrationMethod::ndt) {
    return {.method = gpu::kNdt, .neighbours = 7};
  }
  return {.robust = gpu::kCauchy};
}

// The alignment from an untrusted prediction must match this many times as many points as the
// search's to be accepted instead. A sensor at rest sees its own scan pattern again, so that no
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

// Farther apart than this are two places.
constexpr double kOtherPlace = 0.5;  // m
constexpr double kOtherTurn = 0.2;   // rad

bool are_apart(const RegistrationResult& a, const RegistrationResult& b) {
  const Eigen::Isometry3d off = a.T_target_source.inverse() * b.T_target_source;
  return off.translation().norm() > kOtherPlace || rotation_angle(off.linear()) > kOtherTurn;
}

/// The one that most points match, with its best competing pose, elsewhere.
RegistrationResult best_of(const std::vector<RegistrationResult>& found) {
  const auto rank = [](const RegistrationResult& result) {
    return is_usable(result.status) ? result.inliers : -1;
  };
  RegistrationResult best = *std::ranges::max_element(found, {}, rank);
  for (const RegistrationResult& other : found) {
    if (is_usable(best.status) && is_usable(other.status) && are_apart(best, other)) {
      best.competing_share =
          std::max(best.competing_share, static_cast<double>(other.inliers) / best.inliers);
    }
  }
  return best;
}

}  // namespace

Aligner::Aligner(engine::Context& context, const RegistrationConfig& config)
    : config_(config),
      method_(method_of(config)),
      kernels_(context, options_of(method_)),
      upload_(
          context.make_buffer(kStateAt + kStateBytes, engine::Memory::upload, "alignment start")),
      jobs_(context.make_buffer(kLevels * kJobStride, engine::Memory::device, "alignment jobs")),
      progress_(context.make_buffer(kProgressBytes, engine::Memory::device, "alignment progress")),
      states_(context.make_buffer(kStateBytes, engine::Memory::device, "alignment")),
      scratch_(
          context.make_buffer(kernels_.scratch_bytes(kMostStarts, kernels_.groups(kLargestSweep)),
                              engine::Memory::device, "alignment scratch")),
      readback_(context.make_buffer(kMapCountersAt + sizeof(gpu::VoxelMapCounters),
                                    engine::Memory::readback, "alignment back")) {
  steps_.fill(kFewSteps);
}

void Aligner::record(engine::Recorder& recorder, const Prediction& prediction,
                     std::span<const Eigen::Isometry3d> places, engine::Slice surface_cloud,
                     engine::Slice counters, uint32_t most_points, Submap& submap) {
  groups_ = kernels_.groups(most_points);
  trusted_ = prediction.trusted;
  weighed_ = trusted_ && prediction.information.has_value();
  const engine::RegistrationSettings fine = settings(trusted_);
  record_starts(recorder, prediction, places, submap);
  record_jobs(recorder, 0, submap.voxel_map(), config_.d_max, counters);
  const engine::RegistrationArguments from_prediction =
      arguments(false, 0, surface_cloud, submap.voxel_map());
  engine::RegistrationKernels::record_start(recorder, from_prediction);
  // A search is rare, and has its price anyway.
  recorded_ = starts_ > 0 ? most_passes(fine) : expected_passes(fine);
  record_fine(recorder, from_prediction, fine, recorded_);
  if (starts_ > 0) {
    record_search(recorder, surface_cloud, counters, submap);
    const engine::RegistrationSettings untrusted = settings(false);
    const engine::RegistrationArguments search =
        arguments(true, 0, surface_cloud, submap.voxel_map());
    engine::RegistrationKernels::record_start(recorder, search);
    record_fine(recorder, search, untrusted, most_passes(untrusted));
  }
  record_readback(recorder, submap);
}

void Aligner::record_rest(engine::Recorder& recorder, engine::Slice surface_cloud,
                          const Submap& submap) {
  // As many again as there were. Constrained steps had nothing to do while the others went on.
  const bool iterates = header().iterate.remaining > 0;
  const Passes more{
      .steps = iterates ? std::max(recorded_.steps, 1U) : 0,
      .constrained_steps = trusted_ ? std::max(recorded_.constrained_steps, kFewSteps) : 0};
  recorded_ = {
      .steps = recorded_.steps + more.steps,
      .constrained_steps = (iterates ? 0 : recorded_.constrained_steps) + more.constrained_steps};
  record_fine(recorder, arguments(false, 0, surface_cloud, submap.voxel_map()), settings(trusted_),
              more);
  record_readback(recorder, submap);
}

// Every alignment that there is has ended by as many steps as it may take.
bool Aligner::unfinished() const {
  const Passes most = most_passes(settings(trusted_));
  return (header().iterate.remaining > 0 && recorded_.steps < most.steps) ||
         (header().constrained.remaining > 0 &&
          recorded_.constrained_steps < most.constrained_steps);
}

const gpu::RegistrationHeader& Aligner::header() const {
  return *reinterpret_cast<const gpu::RegistrationHeader*>(readback_.mapped() + kProgressBackAt);
}

Aligner::Passes Aligner::most_passes(const engine::RegistrationSettings& settings) const {
  using Stage = engine::RegistrationKernels::Stage;
  return {.steps = kernels_.passes(Stage::iterate, settings),
          .constrained_steps = kernels_.passes(Stage::constrain, settings)};
}

Aligner::Passes Aligner::expected_passes(const engine::RegistrationSettings& settings) const {
  const Passes most = most_passes(settings);
  const uint32_t steps = *std::ranges::max_element(steps_) + 1;
  if (weighed_) {
    return {.steps = 0, .constrained_steps = std::min(steps, most.constrained_steps)};
  }
  const uint32_t constrained = constrained_steps_ > 0 ? constrained_steps_ + 1 : 0;
  return {.steps = std::min(steps, most.steps),
          .constrained_steps = std::min(constrained, most.constrained_steps)};
}

// Steps before constrained ones are not counted on the device.
void Aligner::note_passes(const RegistrationResult& result) {
  const auto steps = static_cast<uint32_t>(result.iterations);
  const bool followed = result.used_prior && !weighed_;  // steps without the prior, that is
  constrained_steps_ = followed ? steps : 0;
  if (!followed) {
    steps_[next_] = steps;
    next_ = (next_ + 1) % steps_.size();
  }
}

void Aligner::record_readback(engine::Recorder& recorder, const Submap& submap) {
  recorder.copy(states_, readback_.slice(0, kStateBytes));
  recorder.copy(progress_, readback_.slice(kProgressBackAt, kProgressBytes));
  recorder.copy(submap.voxel_map().counters,
                readback_.slice(kMapCountersAt, sizeof(gpu::VoxelMapCounters)));
}

// What the alignment and the search start from.
void Aligner::record_starts(engine::Recorder& recorder, const Prediction& prediction,
                            std::span<const Eigen::Isometry3d> places, const Submap& submap) {
  starts_ = static_cast<uint32_t>(std::min(places.size(), kMostPlaces));
  std::byte* start = upload_.mapped() + kStartAt;
  engine::RegistrationKernels::write_start({start, progress_bytes(1)}, 1, groups_,
                                           weighed_ ? gpu::kPhaseConstrained : gpu::kPhaseIterate);
  const Matrix6d prior = weighed_
                             ? *prediction.information
                             : Matrix6d(prediction.sigma.cwiseAbs2().cwiseInverse().asDiagonal());
  const auto state_of = [&](const Eigen::Isometry3d& T_map_lidar) {
    return initial_state(submap.pose().inverse() * T_map_lidar, prior, weighed_);
  };
  std::byte* states = upload_.mapped() + kStateAt;
  *reinterpret_cast<gpu::RegistrationState*>(states) = state_of(prediction.T_map_lidar);
  recorder.copy(upload_.slice(kStateAt, state_bytes(1)), states_.slice(0, state_bytes(1)));
  if (starts_ == 0) {
    return;
  }
  engine::RegistrationKernels::write_start({start + kProgressStride, progress_bytes(starts_)},
                                           starts_, groups_);
  for (uint32_t k = 0; k < starts_; ++k) {
    reinterpret_cast<gpu::RegistrationState*>(states + kStateStride)[k] = state_of(places[k]);
  }
  recorder.copy(upload_.slice(kStateAt + kStateStride, state_bytes(starts_)),
                states_.slice(kStateStride, state_bytes(starts_)));
}

// The jobs of a level: from the host, but for the number of points.
void Aligner::record_jobs(engine::Recorder& recorder, size_t level,
                          const engine::VoxelMapView& target, double d_max,
                          engine::Slice counters) {
  const NdtScore score =
      method_ == RegistrationMethod::ndt ? ndt_score(target.voxel_size) : NdtScore{.weight = 1.0};
  const gpu::RegistrationJob job{.source_begin = 0,
                                 .source_count = 0,
                                 .target_begin = 0,
                                 .table_mask = target.slots() - 1,
                                 .groups = groups_,
                                 .cell = static_cast<float>(target.voxel_size),
                                 .inverse_cell = static_cast<float>(1.0 / target.voxel_size),
                                 .max_squared = static_cast<float>(d_max * d_max),
                                 .wide_squared = 0.0F,
                                 .wide_iterations = 0,
                                 .score_weight = static_cast<float>(score.weight),
                                 .score_exponent = static_cast<float>(score.exponent),
                                 .viewpoint = {},
                                 .unused0 = 0};
  const uint32_t count = std::max(starts_, 1U);
  const uint64_t at = level * kJobStride;
  const engine::Slice jobs = jobs_.slice(at, count * sizeof(gpu::RegistrationJob));
  std::fill_n(reinterpret_cast<gpu::RegistrationJob*>(upload_.mapped() + at), count, job);
  recorder.copy(upload_.slice(at, count * sizeof(gpu::RegistrationJob)), jobs);
  recorder.barrier();
  for (uint64_t k = 0; k < count; ++k) {
    recorder.copy(
        counters.sub(offsetof(gpu::SweepCounters, cloud_points), sizeof(uint32_t)),
        jobs.sub(k * sizeof(gpu::RegistrationJob) + offsetof(gpu::RegistrationJob, source_count),
                 sizeof(uint32_t)));
  }
}

engine::RegistrationArguments Aligner::arguments(bool search, size_t level,
                                                 engine::Slice surface_cloud,
                                                 const engine::VoxelMapView& target) const {
  const uint32_t count = search ? starts_ : 1;
  const uint64_t progress_at = search ? kProgressStride : 0;
  return {.count = count,
          .group_stride = groups_,
          .source = surface_cloud,
          .target = target.table,
          .jobs = jobs_.slice(level * kJobStride, count * sizeof(gpu::RegistrationJob)),
          .start = upload_.slice(kStartAt + progress_at, progress_bytes(count)),
          .progress = progress_.slice(progress_at, progress_bytes(count)),
          .states = states_.slice(search ? kStateStride : 0, state_bytes(count))};
}

void Aligner::record_search(engine::Recorder& recorder, engine::Slice surface_cloud,
                            engine::Slice counters, Submap& submap) {
  for (size_t level = 1; level < kLevels; ++level) {
    const engine::VoxelMapView target = submap.record_coarse(recorder, kCoarseFactors[level - 1]);
    record_jobs(recorder, level, target, target.voxel_size, counters);
    const engine::Scope scope = recorder.scope("coarse alignment");
    kernels_.record_steps(recorder, kCoarseSettings, arguments(true, level, surface_cloud, target),
                          scratch_);
  }
}

engine::RegistrationSettings Aligner::settings(bool trusted) const {
  return {.translation_epsilon = config_.translation_epsilon,
          .rotation_epsilon = config_.rotation_epsilon,
          .max_iterations = static_cast<uint32_t>(config_.max_iterations),
          .max_constrained = trusted ? static_cast<uint32_t>(config_.max_iterations) : 0,
          .weak_share = 0.0,  // a constant velocity knows less than a few matches
          .robust_width = kRobustWidth};
}

void Aligner::record_fine(engine::Recorder& recorder,
                          const engine::RegistrationArguments& arguments,
                          const engine::RegistrationSettings& settings, const Passes& passes) {
  using Stage = engine::RegistrationKernels::Stage;
  const auto record = [&](Stage stage, uint32_t count) {
    kernels_.record(recorder, stage, 0, count, settings, arguments, scratch_);
  };
  if (passes.steps > 0) {
    {
      const engine::Scope scope = recorder.scope("alignment");
      record(Stage::iterate, passes.steps);
    }
    const engine::Scope scope = recorder.scope("assessment");
    record(Stage::geometry, kernels_.passes(Stage::geometry, settings));
  }
  if (passes.constrained_steps > 0) {
    const engine::Scope scope = recorder.scope("constrained alignment");
    record(Stage::constrain, passes.constrained_steps);
    record(Stage::geometry_again, kernels_.passes(Stage::geometry_again, settings));
  }
}

RegistrationResult Aligner::read_result(int source_points, const Submap& submap) {
  const auto read = [&](bool search, uint32_t k) {
    const std::byte* states = readback_.mapped() + (search ? kStateStride : 0);
    const std::byte* progress = readback_.mapped() + kProgressBackAt +
                                (search ? kProgressStride : 0) + sizeof(gpu::RegistrationHeader);
    return read_registration({reinterpret_cast<const gpu::RegistrationState*>(states)[k],
                              reinterpret_cast<const gpu::RegistrationProgress*>(progress)[k]},
                             source_points,
                             method_ == RegistrationMethod::vgicp ? kFictitious : 0.0, config_);
  };
  RegistrationResult result = read(false, 0);
  note_passes(result);
  if (starts_ > 0) {
    std::vector<RegistrationResult> found;
    for (uint32_t k = 0; k < starts_; ++k) {
      found.push_back(read(true, k));
    }
    result = better(result, best_of(found));
  }
  result.T_target_source = orthonormalized(submap.pose() * result.T_target_source);
  return result;
}

gpu::VoxelMapCounters Aligner::read_map_counters() const {
  return *reinterpret_cast<const gpu::VoxelMapCounters*>(readback_.mapped() + kMapCountersAt);
}

}  // namespace adit
