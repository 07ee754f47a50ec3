// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/batch_chunk.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "adit/shaders/shared/registration.h"

namespace adit {
namespace {

// Coarse levels need not be exact.
constexpr double kCoarseTranslationEpsilon = 5e-3;  // m
constexpr double kCoarseRotationEpsilon = 1e-3;     // rad

bool is_gaussian(RegistrationMethod method) {
  return method == RegistrationMethod::ndt || method == RegistrationMethod::ndt_to_ndt;
}

float squared(double length) {
  return static_cast<float>(length * length);
}

// The device's pose, between clouds about their origins, from one between the clouds' frames.
Eigen::Isometry3d about_origins(const AlignmentPair& pair, const Eigen::Isometry3d& pose) {
  return Eigen::Translation3d(-pair.target->origin) * pose *
         Eigen::Translation3d(pair.source->origin);
}

uint64_t states_bytes(size_t count) {
  return count * sizeof(gpu::RegistrationState);
}

uint64_t progress_bytes(size_t count) {
  return engine::RegistrationKernels::progress_bytes(static_cast<uint32_t>(count));
}

gpu::RegistrationJob job_of(const AlignmentPair& pair, size_t level, const AlignmentSettings& s,
                            uint64_t source_at, uint64_t target_at, uint32_t groups,
                            uint32_t wide_iterations) {
  const AlignmentTarget::Level& target = pair.target->levels[level];
  const bool finest = level + 1 == pair.target->levels.size();
  const NdtScore score = ndt_score(target.voxel_size);
  const bool gaussian = is_gaussian(s.method);
  const Eigen::Vector3f viewpoint = (pair.target->viewpoint - pair.target->origin).cast<float>();
  return {.source_begin = static_cast<uint32_t>(source_at / sizeof(gpu::uvec4)),
          .source_count = source_count(pair, level),
          .target_begin = static_cast<uint32_t>(target_at / sizeof(gpu::uvec4)),
          .table_mask = target.slots - 1,
          .groups = groups,
          .cell = static_cast<float>(target.voxel_size),
          .inverse_cell = static_cast<float>(1.0 / target.voxel_size),
          .max_squared = squared(finest ? s.d_max : target.voxel_size),
          .wide_squared = squared(std::max(s.d_max_wide, s.d_max)),
          .wide_iterations = finest ? wide_iterations : 0,
          .score_weight = gaussian ? static_cast<float>(score.weight) : 1.0F,
          .score_exponent = gaussian ? static_cast<float>(score.exponent) : 0.0F,
          .viewpoint = {viewpoint.x(), viewpoint.y(), viewpoint.z()},
          .unused0 = 0};
}

}  // namespace

uint64_t GatheredBuffers::offset_of(const engine::Buffer& buffer) {
  const auto [found, added] = offsets_.try_emplace(&buffer, bytes_);
  if (added) {
    parts_.push_back(&buffer);
    bytes_ += engine::align_slice(buffer.size());
  }
  return found->second;
}

uint64_t GatheredBuffers::bytes_with(const engine::Buffer& buffer) const {
  return bytes_ + (offsets_.contains(&buffer) ? 0 : engine::align_slice(buffer.size()));
}

engine::Slice GatheredBuffers::record(engine::Context& context, engine::Recorder& recorder,
                                      std::vector<engine::Buffer>& arenas) const {
  if (parts_.size() == 1) {
    return *parts_.front();
  }
  arenas.push_back(context.make_buffer(bytes_, engine::Memory::device, "batch"));
  for (const engine::Buffer* part : parts_) {
    recorder.copy(*part, arenas.back().slice(offsets_.at(part), part->size()));
  }
  return arenas.back();
}

const engine::Buffer& source_of(const AlignmentPair& pair, size_t level) {
  return pair.source_map != nullptr ? pair.source_map->levels[level].table : pair.source->points;
}

uint32_t source_count(const AlignmentPair& pair, size_t level) {
  return pair.source_map != nullptr ? pair.source_map->levels[level].slots : pair.source->size;
}

BatchChunk::BatchChunk(engine::Context& context, const engine::RegistrationKernels& kernels,
                       const AlignmentSettings& settings, std::vector<const AlignmentPair*> pairs,
                       bool steps)
    : context_(&context),
      kernels_(&kernels),
      settings_(settings),
      pairs_(std::move(pairs)),
      steps_(steps),
      levels_(pairs_.front()->target->levels.size()),
      jobs_stride_(engine::align_slice(pairs_.size() * sizeof(gpu::RegistrationJob))),
      start_at_(levels_ * jobs_stride_),
      states_at_(start_at_ + engine::align_slice(progress_bytes(pairs_.size()))),
      upload_(context.make_buffer(states_at_ + states_bytes(pairs_.size()), engine::Memory::upload,
                                  "batch start")),
      progress_(context.make_buffer(progress_bytes(pairs_.size()), engine::Memory::device,
                                    "batch progress")),
      states_(
          context.make_buffer(states_bytes(pairs_.size()), engine::Memory::device, "batch states")),
      scratch_([&] {
        for (const AlignmentPair* pair : pairs_) {
          points_ += source_count(*pair, levels_ - 1);
          for (size_t level = 0; level < levels_; ++level) {
            group_stride_ = std::max(group_stride_, kernels.groups(source_count(*pair, level)));
          }
        }
        return context.make_buffer(
            kernels.scratch_bytes(static_cast<uint32_t>(pairs_.size()), group_stride_),
            engine::Memory::device, "batch scratch");
      }()),
      readback_(context.make_buffer(
          engine::align_slice(states_bytes(pairs_.size())) + progress_bytes(pairs_.size()),
          engine::Memory::readback, "batch results")),
      level_(steps ? 0 : levels_ - 1) {
  const auto count = static_cast<uint32_t>(pairs_.size());
  auto* initial = reinterpret_cast<gpu::RegistrationState*>(upload_.mapped() + states_at_);
  for (size_t i = 0; i < pairs_.size(); ++i) {
    initial[i] = initial_state(about_origins(*pairs_[i], pairs_[i]->T_target_source),
                               pairs_[i]->prior_information);
  }
  engine::RegistrationKernels::write_start({upload_.mapped() + start_at_, progress_.size()}, count,
                                           group_stride_,
                                           steps ? gpu::kPhaseIterate : gpu::kPhaseAssess);
  arenas_.reserve(2 * levels_);  // slices refer to them
}

engine::RegistrationSettings BatchChunk::level_settings() const {
  const bool finest = level_ + 1 == levels_;
  const auto most = static_cast<uint32_t>(settings_.max_iterations);
  return {.translation_epsilon = finest ? settings_.translation_epsilon : kCoarseTranslationEpsilon,
          .rotation_epsilon = finest ? settings_.rotation_epsilon : kCoarseRotationEpsilon,
          .max_iterations = steps_ ? most : 0,
          .max_constrained = steps_ && settings_.resolve_weak ? most : 0,
          .robust_width = settings_.robust_width};
}

void BatchChunk::begin_level(engine::Recorder& recorder) {
  if (level_ == (steps_ ? 0 : levels_ - 1)) {
    recorder.copy(upload_.slice(states_at_, states_.size()), states_);
  }
  GatheredBuffers sources;
  GatheredBuffers targets;
  auto* jobs = reinterpret_cast<gpu::RegistrationJob*>(upload_.mapped() + level_ * jobs_stride_);
  for (size_t i = 0; i < pairs_.size(); ++i) {
    const AlignmentPair& pair = *pairs_[i];
    jobs[i] = job_of(pair, level_, settings_, sources.offset_of(source_of(pair, level_)),
                     targets.offset_of(pair.target->levels[level_].table),
                     kernels_->groups(source_count(pair, level_)),
                     steps_ ? static_cast<uint32_t>(settings_.wide_iterations) : 0);
  }
  arguments_ = {
      .count = static_cast<uint32_t>(pairs_.size()),
      .group_stride = group_stride_,
      .source = sources.record(*context_, recorder, arenas_),
      .target = targets.record(*context_, recorder, arenas_),
      .jobs = upload_.slice(level_ * jobs_stride_, pairs_.size() * sizeof(gpu::RegistrationJob)),
      .start = upload_.slice(start_at_, progress_.size()),
      .progress = progress_,
      .states = states_};
  engine::RegistrationKernels::record_start(recorder, arguments_);
  begun_ = true;
}

void BatchChunk::next_stage() {
  pass_ = 0;
  if (stage_ != Stage::geometry_again && level_ + 1 == levels_) {
    stage_ = static_cast<Stage>(static_cast<int>(stage_) + 1);
    return;
  }
  ++level_;
  stage_ = Stage::iterate;
  begun_ = false;
}

uint32_t BatchChunk::record(engine::Recorder& recorder, uint32_t most) {
  uint32_t recorded_passes = 0;
  while (!recorded()) {
    const engine::RegistrationSettings settings = level_settings();
    const uint32_t left = kernels_->passes(stage_, settings) - pass_;
    if (left == 0 && (begun_ || stage_ != Stage::iterate)) {
      next_stage();
      if (recorded_passes > 0 && most != kAllPasses) {
        break;
      }
      continue;
    }
    if (recorded_passes == most) {
      break;
    }
    if (!begun_) {
      begin_level(recorder);
    }
    const uint32_t now = std::min(left, most - recorded_passes);
    const engine::Scope scope =
        recorder.scope(stage_ == Stage::iterate ? "alignment" : "assessment");
    kernels_->record(recorder, stage_, pass_, now, settings, arguments_, scratch_);
    pass_ += now;
    recorded_passes += now;
  }
  if (recorded()) {
    recorder.copy(states_, readback_.slice(0, states_.size()));
  }
  recorder.copy(progress_, readback_.slice(engine::align_slice(states_.size()), progress_.size()));
  return recorded_passes;
}

uint32_t BatchChunk::look() {
  if (recorded() || !begun_) {
    return recorded() ? 0 : static_cast<uint32_t>(pairs_.size());
  }
  uint32_t remaining = 0;
  std::memcpy(&remaining,
              readback_.mapped() + engine::align_slice(states_.size()) +
                  engine::RegistrationKernels::remaining_at(stage_),
              sizeof(remaining));
  const bool counted = stage_ == Stage::iterate || stage_ == Stage::constrain;
  if (counted && remaining == 0) {
    next_stage();
    return look();
  }
  return counted ? remaining : static_cast<uint32_t>(pairs_.size());
}

std::vector<RegistrationResult> BatchChunk::results() const {
  const auto* found = reinterpret_cast<const gpu::RegistrationState*>(readback_.mapped());
  const auto* ended = reinterpret_cast<const gpu::RegistrationProgress*>(
      readback_.mapped() + engine::align_slice(states_.size()) + sizeof(gpu::RegistrationHeader));
  RegistrationConfig limits;
  limits.min_inliers = settings_.min_inliers;
  limits.min_overlap = settings_.min_overlap;
  const double fictitious = kernels_->options().method == gpu::kVgicp ? 0.5 : 0.0;
  std::vector<RegistrationResult> results;
  for (size_t i = 0; i < pairs_.size(); ++i) {
    const AlignmentPair& pair = *pairs_[i];
    const uint32_t points =
        pair.source_map != nullptr ? pair.source_map->voxels : pair.source->size;
    RegistrationResult result =
        read_registration({found[i], ended[i]}, static_cast<int>(points), fictitious, limits);
    result.T_target_source = Eigen::Translation3d(pair.target->origin) * result.T_target_source *
                             Eigen::Translation3d(-pair.source->origin);
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace adit
