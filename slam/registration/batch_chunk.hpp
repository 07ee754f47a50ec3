// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Pairs of a batch that share their dispatches, on the device.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

#include "adit/engine/context.hpp"
#include "adit/slam/registration/batch_aligner.hpp"

namespace adit {

/// Buffers of a batch by the clouds and tables they hold: each once.
class GatheredBuffers {
 public:
  /// Where the buffer's content will be, in bytes.
  uint64_t offset_of(const engine::Buffer& buffer);
  uint64_t bytes() const { return bytes_; }
  /// So many it would be with this one.
  uint64_t bytes_with(const engine::Buffer& buffer) const;
  /// The one buffer itself, or copies of all of them in a new one that `arenas` keeps.
  engine::Slice record(engine::Context& context, engine::Recorder& recorder,
                       std::vector<engine::Buffer>& arenas) const;

 private:
  std::map<const engine::Buffer*, uint64_t> offsets_;
  std::vector<const engine::Buffer*> parts_;
  uint64_t bytes_ = 0;
};

/// What a pair's source and target are on a level.
const engine::Buffer& source_of(const AlignmentPair& pair, size_t level);
uint32_t source_count(const AlignmentPair& pair, size_t level);

/// Alignments that share every dispatch, from their start to their results, in as many submissions
/// as one likes.
class BatchChunk {
 public:
  using Stage = engine::RegistrationKernels::Stage;

  /// `pairs` can be aligned and fit the device; without `steps` they are assessed as they are.
  BatchChunk(engine::Context& context, const engine::RegistrationKernels& kernels,
             const AlignmentSettings& settings, std::vector<const AlignmentPair*> pairs,
             bool steps);
  BatchChunk(const BatchChunk&) = delete;  // slices refer to its buffers
  BatchChunk& operator=(const BatchChunk&) = delete;

  uint32_t size() const { return static_cast<uint32_t>(pairs_.size()); }
  uint64_t points() const { return points_; }  ///< total of the sources
  bool recorded() const { return level_ == levels_; }
  Stage stage() const { return stage_; }                 ///< of what is recorded next
  bool is_between_stages() const { return pass_ == 0; }  ///< what is recorded next begins one

  static constexpr uint32_t kAllPasses = std::numeric_limits<uint32_t>::max();
  /// The next passes, `most` at most and one at least; returns how many. Unless `most` is
  /// kAllPasses, they are of one stage: another one concerns other pairs. The last of all are
  /// followed by the copy of the results.
  uint32_t record(engine::Recorder& recorder, uint32_t most);
  /// After the wait for what was recorded: passes over steps that nobody needs any more. Returns
  /// how many pairs still want what comes next.
  uint32_t look();
  /// In the order of the pairs, after the wait for the last passes.
  std::vector<RegistrationResult> results() const;

 private:
  void begin_level(engine::Recorder& recorder);
  void next_stage();
  engine::RegistrationSettings level_settings() const;

  engine::Context* context_;
  const engine::RegistrationKernels* kernels_;
  AlignmentSettings settings_;
  std::vector<const AlignmentPair*> pairs_;
  bool steps_;
  uint64_t points_ = 0;
  uint32_t group_stride_ = 0;
  size_t levels_;
  uint64_t jobs_stride_ = 0;  ///< bytes between levels' jobs in the upload
  uint64_t start_at_ = 0;
  uint64_t states_at_ = 0;
  engine::Buffer upload_;
  engine::Buffer progress_;
  engine::Buffer states_;
  engine::Buffer scratch_;
  engine::Buffer readback_;
  std::vector<engine::Buffer> arenas_;
  engine::RegistrationArguments arguments_;
  size_t level_;
  Stage stage_ = Stage::iterate;
  uint32_t pass_ = 0;   ///< number within the stage
  bool begun_ = false;  ///< the level
};

}  // namespace adit
