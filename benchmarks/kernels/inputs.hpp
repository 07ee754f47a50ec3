// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The clouds that benchmarks run on: those of the tests, in any size, or the user's own.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "adit/benchmarks/verify/alignment_scene.hpp"
#include "adit/benchmarks/verify/cases.hpp"

namespace adit::bench {

/// A device with the clouds on it: what all cases share.
class Bench {
 public:
  /// Without files the simulated street of the tests. Else a recording's first two sweeps, or the
  /// sweep of each of two files, down-sampled to `r_input` (m); their relative pose is not known.
  /// With one sweep alone the second is the same, moved by a known pose. Throws InputError.
  Bench(engine::Context& context, const std::vector<std::filesystem::path>& files, double r_input);

  engine::Context& context() { return *context_; }
  std::string description() const { return description_; }
  /// The size of the given clouds, in points, or what is asked for.
  std::vector<int> sizes(const std::vector<int>& wanted) const;

  /// About `points` raw points; above 200 000 with r_input 0.05 m, so that as many voxels remain.
  const test::AlignmentCase& alignment(int points);
  /// The same, preprocessed, with the target's map, on the device.
  const test::AlignmentScene& scene(int points);
  /// The pose that alignments start from: 0.4 m and 3 degrees off; the identity where the truth is
  /// not known.
  Eigen::Isometry3d start(int points);
  bool knows_truth() const { return truth_known_; }

 private:
  engine::Context* context_;
  std::unique_ptr<test::AlignmentCase> given_;
  bool truth_known_ = true;
  std::string description_;
  std::map<int, test::AlignmentCase> alignments_;
  std::map<int, std::unique_ptr<test::AlignmentScene>> scenes_;
};

}  // namespace adit::bench
