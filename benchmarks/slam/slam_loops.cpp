// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/slam/slam_loops.hpp"

#include <algorithm>
#include <vector>

#include <nlohmann/json.hpp>

#include "adit/tools/evaluation/loop_table.hpp"
#include "adit/tools/results/run_outputs.hpp"

namespace adit::bench {
namespace {

using namespace nlohmann::literals;

constexpr double kTolerance = 0.01;  // s, of matched poses, as `adit evaluate` has it

/// Candidates a second of the time that the search took in all.
std::optional<double> rate_of(const nlohmann::json& map) {
  if (!map.contains("loops")) {
    return std::nullopt;
  }
  const auto& loops = map.at("loops");
  const double searched = 1e-3 * loops.at("/keyframe_ms/mean"_json_pointer).get<double>() *
                          map.at("keyframes").get<double>();
  return searched > 0.0 ? std::optional(loops.at("candidates").get<double>() / searched)
                        : std::nullopt;
}

}  // namespace

std::optional<SlamLoops> loops_of_run(const SlamSequence& sequence,
                                      const std::filesystem::path& folder,
                                      const nlohmann::json& summary) {
  if (!sequence.loops || !summary.contains("map")) {
    return std::nullopt;
  }
  const RunLoops run = evaluate_loops(folder, truth_of(sequence), *sequence.loops, kTolerance);
  const auto& map = summary.at("map");
  return SlamLoops{.accepted = run.score.accepted,
                   .false_ones = run.score.false_ones,
                   .effect = run.effect,
                   .search = SlamLoopSearch{.revisits = run.score.revisits.size(),
                                            .found = static_cast<std::size_t>(std::ranges::count(
                                                run.score.revisits, true, &Revisit::found)),
                                            .offered = run.score.offered,
                                            .removed = run.score.removed,
                                            .a_second = rate_of(map),
                                            .keyframe_ms = map.at("/keyframe_ms/mean"_json_pointer),
                                            .longest_wait_s = map.at("longest_wait_s")}};
}

std::optional<SlamLoops> loops_of_system(const SlamSequence& sequence,
                                         const std::filesystem::path& system) {
  const std::filesystem::path table = file_of(system, sequence, ".loops.csv");
  if (!std::filesystem::exists(table)) {
    return std::nullopt;
  }
  const std::vector<MeasuredLoop> loops = read_measured_loops(table);
  const Trajectory truth = truth_of(sequence);
  const MeasuredLoopScore score = score_loops(loops, truth);
  return SlamLoops{.accepted = score.accepted,
                   .false_ones = score.false_ones,
                   .effect = loop_effect(file_of(system, sequence, ".odometry.tum"),
                                         file_of(system, sequence), truth, score.span, kTolerance),
                   .search = std::nullopt};
}

}  // namespace adit::bench
