// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/batch_aligner.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "adit/engine/context.hpp"
#include "adit/engine/submission.hpp"
#include "adit/shaders/shared/registration.h"
#include "adit/slam/registration/batch_chunk.hpp"

namespace adit {
namespace {

using Clock = std::chrono::steady_clock;

// A pass over one source point on a device that is not yet measured: slower than any.
constexpr double kSlowest = 5e-4;  // ms
// Of a piece between two checkpoints: what waits for one waits a few times as long at most, and the
// host's share of a piece stays small.
constexpr double kPieceBudget = 50.0;  // ms
// A chunk is small enough for so many passes in one piece, where it can be.
constexpr double kPassesOfAPiece = 4.0;

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
          .many = true,
          .drop_back_faces = settings.drop_back_faces};
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

std::vector<RegistrationResult> BatchAligner::align(std::span<const AlignmentPair> pairs,
                                                    const Checkpoint& checkpoint) const {
  return begin(pairs).finish(checkpoint);
}

std::vector<RegistrationResult> BatchAligner::evaluate(std::span<const AlignmentPair> pairs,
                                                       const Checkpoint& checkpoint) const {
  return start(pairs, false).finish(checkpoint);
}

BatchAlignment BatchAligner::begin(std::span<const AlignmentPair> pairs) const {
  return start(pairs, true);
}

struct BatchAlignment::State {
  engine::Context* context;
  const engine::RegistrationKernels* kernels;
  AlignmentSettings settings;
  bool steps;
  std::vector<AlignmentPair> pairs;
  std::vector<RegistrationResult> results;
  std::vector<size_t> waiting;  // pairs that can be aligned
  size_t next = 0;              // index of the next of them
  std::vector<size_t> taken;    // by the chunk
  std::unique_ptr<BatchChunk> chunk{};
  uint32_t alive = 0;  // pairs of the chunk that want the next pass
  std::array<double, 4> ms_per_point{kSlowest, kSlowest, kSlowest, kSlowest};  // a pass, by stage
  BatchChunk::Stage stage{};  // of the piece under way
  double alive_points = 0.0;  // of the pairs that wanted the piece under way
  uint32_t passes = 0;        // of the piece under way
  Clock::time_point submitted{};
  std::optional<engine::Submission> under_way{};  // destroyed first

  double& ms_per_point_of(BatchChunk::Stage one) {
    return ms_per_point.at(static_cast<size_t>(one));
  }
  void make_chunk(double budget);
  void learn(double elapsed, bool waited, double still_alive);
};

BatchAlignment BatchAligner::start(std::span<const AlignmentPair> pairs, bool steps) const {
  auto state = std::make_unique<BatchAlignment::State>(
      BatchAlignment::State{.context = context_,
                            .kernels = &kernels_,
                            .settings = settings_,
                            .steps = steps,
                            .pairs = {pairs.begin(), pairs.end()},
                            .results = std::vector<RegistrationResult>(pairs.size()),
                            .waiting = {},
                            .taken = {}});
  for (size_t i = 0; i < pairs.size(); ++i) {
    const AlignmentPair& pair = pairs[i];
    check(pair, pairs.front(), settings_);
    RegistrationResult& result = state->results[i];
    result.T_target_source = pair.T_target_source;
    result.source_points = static_cast<int>(pair.source->size);
    if (can_run(pair)) {
      state->waiting.push_back(i);
      continue;
    }
    const bool finite = pair.T_target_source.matrix().allFinite();
    result.status = finite ? RegistrationStatus::too_few_points : RegistrationStatus::diverged;
  }
  return BatchAlignment(std::move(state));
}

BatchAlignment::BatchAlignment(std::unique_ptr<State> state) : state_(std::move(state)) {}
BatchAlignment::BatchAlignment(BatchAlignment&&) noexcept = default;
BatchAlignment& BatchAlignment::operator=(BatchAlignment&&) noexcept = default;
BatchAlignment::~BatchAlignment() = default;

// As many pairs as their time allows, and as what they refer to fits into one buffer of the device.
void BatchAlignment::State::make_chunk(double budget) {
  const uint64_t room = context->device().max_storage_buffer_bytes;
  const double most_points =
      budget / (kPassesOfAPiece * ms_per_point_of(BatchChunk::Stage::iterate));
  GatheredBuffers sources;
  GatheredBuffers targets;
  std::vector<const AlignmentPair*> chosen;
  taken.clear();
  double chosen_points = 0.0;
  for (size_t i = next; i < waiting.size(); ++i) {
    const AlignmentPair& pair = pairs[waiting[i]];
    const size_t finest = pair.target->levels.size() - 1;
    const engine::Buffer& source = source_of(pair, finest);
    const engine::Buffer& target = pair.target->levels[finest].table;
    chosen_points += source_count(pair, finest);
    if (!chosen.empty() && (chosen_points > most_points || sources.bytes_with(source) > room ||
                            targets.bytes_with(target) > room)) {
      break;
    }
    sources.offset_of(source);
    targets.offset_of(target);
    chosen.push_back(&pair);
    taken.push_back(waiting[i]);
  }
  chunk = std::make_unique<BatchChunk>(*context, *kernels, settings, std::move(chosen), steps);
  next += taken.size();
  alive = chunk->size();
}

// Pairs that end within a piece skip the rest of its passes: between one pass of each pair and all
// passes were computed. `still_alive` is the share of pairs that did not end. A piece that had
// ended before anybody looked took at most so long.
void BatchAlignment::State::learn(double elapsed, bool waited, double still_alive) {
  const double most_passes = std::max(passes, 1U);
  const double least_passes =
      chunk->is_between_stages() ? 1.0 : std::max(1.0, still_alive * most_passes);
  double& ms = ms_per_point_of(stage);
  ms = std::min(ms, elapsed / (alive_points * least_passes));
  if (waited) {
    ms = std::max(ms, elapsed / (alive_points * most_passes));
  }
}

bool BatchAlignment::done() const {
  return !state_->chunk && state_->next == state_->waiting.size();
}

void BatchAlignment::submit(double budget) {
  wait();
  if (done()) {
    return;
  }
  State& s = *state_;
  if (!s.chunk) {
    s.make_chunk(budget);
  }
  s.alive_points =
      static_cast<double>(s.chunk->points()) * s.alive / static_cast<double>(s.chunk->size());
  constexpr double kAll = BatchChunk::kAllPasses;
  s.stage = s.chunk->stage();
  const double passes =
      std::clamp(budget / (s.alive_points * s.ms_per_point_of(s.stage)), 1.0, kAll);
  engine::Recorder recorder = s.context->make_recorder();
  s.passes = s.chunk->record(recorder, static_cast<uint32_t>(passes));
  s.submitted = Clock::now();
  s.under_way.emplace(s.context->submit(std::move(recorder)));
}

void BatchAlignment::wait() {
  State& s = *state_;
  if (!s.under_way) {
    return;
  }
  const bool early = !s.under_way->done();
  s.under_way->wait();
  const std::chrono::duration<double, std::milli> elapsed = Clock::now() - s.submitted;
  s.under_way.reset();
  const uint32_t remaining = s.chunk->look();
  s.learn(elapsed.count(), early, std::min(1.0, static_cast<double>(remaining) / s.alive));
  s.alive = std::max(remaining, 1U);
  if (s.chunk->recorded()) {
    std::vector<RegistrationResult> found = s.chunk->results();
    for (size_t i = 0; i < found.size(); ++i) {
      s.results[s.taken[i]] = std::move(found[i]);
    }
    s.chunk.reset();
  }
}

std::vector<RegistrationResult> BatchAlignment::finish(const Checkpoint& checkpoint) {
  wait();
  while (!done()) {
    pass(checkpoint);
    submit(checkpoint ? kPieceBudget : std::numeric_limits<double>::infinity());
    wait();
  }
  return std::move(state_->results);
}

}  // namespace adit
