// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/batch_aligner.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>

#include "adit/engine/context.hpp"
#include "adit/shaders/shared/registration.h"

namespace adit {
namespace {

// Coarse levels need not be exact.
constexpr double kCoarseTranslationEpsilon = 5e-3;  // m
constexpr double kCoarseRotationEpsilon = 1e-3;     // rad

constexpr double kOutliers = 0.55;  // part of the points that NDT's score takes for outliers

uint32_t to_gpu(RegistrationMethod method) {
  switch (method) {
    case RegistrationMethod::vgicp:
      return gpu::kVgicp;
    case RegistrationMethod::ndt:
      return gpu::kNdt;
    case RegistrationMethod::point_to_plane:
      return gpu::kPointToPlane;
    case RegistrationMethod::ndt_to_ndt:
      return gpu::kNdtToNdt;
  }
  return gpu::kVgicp;
}

uint32_t to_gpu(RobustKernel kernel) {
  switch (kernel) {
    case RobustKernel::none:
      return gpu::kNoRobust;
    case RobustKernel::huber:
      return gpu::kHuber;
    case RobustKernel::cauchy:
      return gpu::kCauchy;
    case RobustKernel::geman_mcclure:
      return gpu::kGemanMcClure;
  }
  return gpu::kNoRobust;
}

engine::RegistrationOptions options_of(const AlignmentSettings& settings) {
  if (settings.neighbours != 1 && settings.neighbours != 7 && settings.neighbours != 27) {
    throw std::logic_error("AlignmentSettings::neighbours is " +
                           std::to_string(settings.neighbours) + "; 1, 7 and 27 are known");
  }
  return {.method = to_gpu(settings.method),
          .neighbours = static_cast<uint32_t>(settings.neighbours),
          .robust = to_gpu(settings.robust),
          .drop_back_faces = settings.drop_back_faces};
}

// Constants of Magnusson's score for a cell size r (m): a Gaussian and a uniform floor.
struct Score {
  double d1 = 0.0;
  double d2 = 0.0;
};

Score score_of(double r) {
  const double c1 = 10.0 * (1.0 - kOutliers);
  const double c2 = kOutliers / (r * r * r);
  const double d3 = -std::log(c2);
  const double d1 = -std::log(c1 + c2) - d3;
  const double d2 = -2.0 * std::log((-std::log(c1 * std::exp(-0.5) + c2) - d3) / d1);
  return {d1, d2};
}

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

// Where things are in the one upload of a batch.
struct Layout {
  uint64_t jobs_stride = 0;  // of a level's jobs
  uint64_t start_at = 0;
  uint64_t states_at = 0;
  uint64_t bytes = 0;

  Layout(size_t levels, uint32_t count)
      : jobs_stride(engine::align_slice(count * sizeof(gpu::RegistrationJob))),
        start_at(levels * jobs_stride),
        states_at(start_at +
                  engine::align_slice(engine::RegistrationKernels::progress_bytes(count))),
        bytes(states_at + count * sizeof(gpu::RegistrationState)) {}
};

// Buffers of a batch by the clouds and tables they hold: each once.
class Gathered {
 public:
  /// Where the buffer's content will be, in bytes.
  uint64_t offset_of(const engine::Buffer& buffer) {
    const auto [found, added] = offsets_.try_emplace(&buffer, bytes_);
    if (added) {
      parts_.push_back(&buffer);
      bytes_ += engine::align_slice(buffer.size());
    }
    return found->second;
  }
  uint64_t bytes() const { return bytes_; }

  /// The one buffer itself, or copies of all of them in `arena`.
  engine::Slice record(engine::Context& context, engine::Recorder& recorder,
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

 private:
  std::map<const engine::Buffer*, uint64_t> offsets_;
  std::vector<const engine::Buffer*> parts_;
  uint64_t bytes_ = 0;
};

const engine::Buffer& source_of(const AlignmentPair& pair, size_t level) {
  return pair.source_map != nullptr ? pair.source_map->levels[level].table : pair.source->points;
}

uint32_t source_count(const AlignmentPair& pair, size_t level) {
  return pair.source_map != nullptr ? pair.source_map->levels[level].slots : pair.source->size;
}

void check(const AlignmentPair& pair, const AlignmentPair& first,
           const AlignmentSettings& settings) {
  if (pair.source == nullptr || pair.target == nullptr) {
    throw std::logic_error("a pair to align lacks its source or target");
  }
  const bool maps = settings.method == RegistrationMethod::ndt_to_ndt;
  if (maps != (pair.source_map != nullptr)) {
    throw std::logic_error(maps ? "NDT to NDT needs the source's map"
                                : "only NDT to NDT takes the source's map");
  }
  if (pair.target->method != settings.method ||
      (maps && pair.source_map->method != settings.method)) {
    throw std::logic_error("the target was made for " +
                           std::string(to_string(pair.target->method)) + ", not for " +
                           std::string(to_string(settings.method)));
  }
  if (pair.target->levels.empty() || pair.target->levels.size() != first.target->levels.size() ||
      (maps && pair.source_map->levels.size() != pair.target->levels.size())) {
    throw std::logic_error("all targets of a batch need the same number of levels, at least one");
  }
}

bool can_run(const AlignmentPair& pair) {
  return pair.source->size > 0 && pair.target->voxels > 0 &&
         pair.T_target_source.matrix().allFinite() && pair.prior_information.allFinite();
}

}  // namespace

BatchAligner::BatchAligner(engine::Context& context, const AlignmentSettings& settings)
    : context_(&context), settings_(settings), kernels_(context, options_of(settings)) {}

std::vector<RegistrationResult> BatchAligner::align(std::span<const AlignmentPair> pairs) {
  return run(pairs, true);
}

std::vector<RegistrationResult> BatchAligner::evaluate(std::span<const AlignmentPair> pairs) {
  return run(pairs, false);
}

// Cuts the batch where what it refers to would not fit into one buffer of the device.
std::vector<RegistrationResult> BatchAligner::run(std::span<const AlignmentPair> pairs,
                                                  bool steps) {
  const uint64_t room = context_->device().max_storage_buffer_bytes;
  std::vector<RegistrationResult> results(pairs.size());
  std::vector<const AlignmentPair*> chunk;
  std::vector<RegistrationResult*> chunk_results;
  Gathered sources;
  Gathered targets;
  const auto flush = [&] {
    if (!chunk.empty()) {
      run_chunk(chunk, steps, chunk_results);
    }
    chunk.clear();
    chunk_results.clear();
    sources = {};
    targets = {};
  };
  for (size_t i = 0; i < pairs.size(); ++i) {
    const AlignmentPair& pair = pairs[i];
    check(pair, pairs.front(), settings_);
    results[i].T_target_source = pair.T_target_source;
    results[i].source_points = static_cast<int>(pair.source->size);
    if (!can_run(pair)) {
      const bool finite = pair.T_target_source.matrix().allFinite();
      results[i].status =
          finite ? RegistrationStatus::too_few_points : RegistrationStatus::diverged;
      continue;
    }
    const auto grown = [&](Gathered gathered, const engine::Buffer& buffer) {
      gathered.offset_of(buffer);
      return gathered.bytes();
    };
    const engine::Buffer& finest = pair.target->levels.back().table;
    if (grown(sources, source_of(pair, pair.target->levels.size() - 1)) > room ||
        grown(targets, finest) > room) {
      flush();
    }
    sources.offset_of(source_of(pair, pair.target->levels.size() - 1));
    targets.offset_of(finest);
    chunk.push_back(&pair);
    chunk_results.push_back(&results[i]);
  }
  flush();
  return results;
}

void BatchAligner::run_chunk(std::span<const AlignmentPair* const> pairs, bool steps,
                             std::span<RegistrationResult* const> results) {
  const auto count = static_cast<uint32_t>(pairs.size());
  const size_t levels = pairs.front()->target->levels.size();
  const size_t first_level = steps ? 0 : levels - 1;
  uint32_t group_stride = 0;
  for (const AlignmentPair* pair : pairs) {
    for (size_t level = 0; level < levels; ++level) {
      group_stride = std::max(group_stride, kernels_.groups(source_count(*pair, level)));
    }
  }

  const Layout layout(levels, count);
  const uint64_t progress_bytes = engine::RegistrationKernels::progress_bytes(count);
  const uint64_t states_bytes = count * sizeof(gpu::RegistrationState);
  const engine::Buffer upload =
      context_->make_buffer(layout.bytes, engine::Memory::upload, "batch start");
  const engine::Buffer progress =
      context_->make_buffer(progress_bytes, engine::Memory::device, "batch progress");
  const engine::Buffer states =
      context_->make_buffer(states_bytes, engine::Memory::device, "batch states");
  const engine::Buffer scratch = context_->make_buffer(kernels_.scratch_bytes(count, group_stride),
                                                       engine::Memory::device, "batch scratch");
  const engine::Buffer readback =
      context_->make_buffer(engine::align_slice(states_bytes) + progress_bytes,
                            engine::Memory::readback, "batch results");
  std::vector<engine::Buffer> arenas;
  arenas.reserve(2 * levels);

  auto* initial = reinterpret_cast<gpu::RegistrationState*>(upload.mapped() + layout.states_at);
  for (size_t i = 0; i < pairs.size(); ++i) {
    initial[i] = initial_state(about_origins(*pairs[i], pairs[i]->T_target_source),
                               pairs[i]->prior_information);
  }
  engine::RegistrationKernels::write_start({upload.mapped() + layout.start_at, progress_bytes},
                                           count, group_stride,
                                           steps ? gpu::kPhaseIterate : gpu::kPhaseAssess);

  engine::Recorder recorder = context_->make_recorder();
  recorder.copy(upload.slice(layout.states_at, states_bytes), states);
  engine::RegistrationSettings level_settings{};
  for (size_t level = first_level; level < levels; ++level) {
    const bool finest = level + 1 == levels;
    Gathered sources;
    Gathered targets;
    auto* jobs =
        reinterpret_cast<gpu::RegistrationJob*>(upload.mapped() + level * layout.jobs_stride);
    for (size_t i = 0; i < pairs.size(); ++i) {
      const AlignmentPair& pair = *pairs[i];
      const AlignmentTarget::Level& target = pair.target->levels[level];
      const Score score = score_of(target.voxel_size);
      const bool gaussian = is_gaussian(settings_.method);
      const Eigen::Vector3f viewpoint =
          (pair.target->viewpoint - pair.target->origin).cast<float>();
      jobs[i] = {
          .source_begin =
              static_cast<uint32_t>(sources.offset_of(source_of(pair, level)) / sizeof(gpu::uvec4)),
          .source_count = source_count(pair, level),
          .target_begin =
              static_cast<uint32_t>(targets.offset_of(target.table) / sizeof(gpu::uvec4)),
          .table_mask = target.slots - 1,
          .groups = kernels_.groups(source_count(pair, level)),
          .cell = static_cast<float>(target.voxel_size),
          .inverse_cell = static_cast<float>(1.0 / target.voxel_size),
          .max_squared = squared(finest ? settings_.d_max : target.voxel_size),
          .wide_squared = squared(std::max(settings_.d_max_wide, settings_.d_max)),
          .wide_iterations = finest && steps ? static_cast<uint32_t>(settings_.wide_iterations) : 0,
          .score_weight = gaussian ? static_cast<float>(-score.d1 * score.d2) : 1.0F,
          .score_exponent = gaussian ? static_cast<float>(0.5 * score.d2) : 0.0F,
          .viewpoint = {viewpoint.x(), viewpoint.y(), viewpoint.z()},
          .unused0 = 0};
    }
    const engine::RegistrationArguments arguments{
        .count = count,
        .group_stride = group_stride,
        .source = sources.record(*context_, recorder, arenas),
        .target = targets.record(*context_, recorder, arenas),
        .jobs = upload.slice(level * layout.jobs_stride, count * sizeof(gpu::RegistrationJob)),
        .start = upload.slice(layout.start_at, progress_bytes),
        .progress = progress,
        .states = states};
    level_settings = {
        .translation_epsilon = finest ? settings_.translation_epsilon : kCoarseTranslationEpsilon,
        .rotation_epsilon = finest ? settings_.rotation_epsilon : kCoarseRotationEpsilon,
        .max_iterations = steps ? static_cast<uint32_t>(settings_.max_iterations) : 0,
        .max_constrained =
            steps && settings_.resolve_weak ? static_cast<uint32_t>(settings_.max_iterations) : 0,
        .robust_width = settings_.robust_width};
    {
      const engine::Scope scope = recorder.scope("alignment");
      kernels_.record_steps(recorder, level_settings, arguments, scratch);
    }
    if (finest) {
      const engine::Scope scope = recorder.scope("assessment");
      kernels_.record_assessment(recorder, level_settings, arguments, scratch);
    }
  }
  recorder.copy(states, readback.slice(0, states_bytes));
  recorder.copy(progress, readback.slice(engine::align_slice(states_bytes), progress_bytes));
  context_->submit(std::move(recorder)).wait();

  const auto* found = reinterpret_cast<const gpu::RegistrationState*>(readback.mapped());
  const auto* ended = reinterpret_cast<const gpu::RegistrationProgress*>(
      readback.mapped() + engine::align_slice(states_bytes) + sizeof(gpu::RegistrationHeader));
  RegistrationConfig limits;
  limits.min_inliers = settings_.min_inliers;
  limits.min_overlap = settings_.min_overlap;
  const double fictitious = kernels_.options().method == gpu::kVgicp ? 0.5 : 0.0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const AlignmentPair& pair = *pairs[i];
    const uint32_t points =
        pair.source_map != nullptr ? pair.source_map->voxels : pair.source->size;
    *results[i] =
        read_registration({found[i], ended[i]}, static_cast<int>(points), fictitious, limits);
    results[i]->T_target_source = Eigen::Translation3d(pair.target->origin) *
                                  results[i]->T_target_source *
                                  Eigen::Translation3d(-pair.source->origin);
  }
}

}  // namespace adit
