// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/run_loops.hpp"

#include <system_error>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

std::optional<Trajectory> trajectory_in(const std::filesystem::path& file) {
  std::error_code unknown;
  return std::filesystem::is_regular_file(file, unknown) ? std::optional(read_trajectory(file))
                                                         : std::nullopt;
}

/// Its poses in a span of time, as one part.
Trajectory within(const Trajectory& trajectory, const LoopSpan& span) {
  Trajectory part = trajectory;
  part.parts.clear();
  std::erase_if(part.poses, [&](const StampedPose& pose) {
    return pose.stamp < span.begin || pose.stamp > span.end;
  });
  return part;
}

std::optional<double> ate_of(const std::optional<Trajectory>& estimate, const Trajectory& truth,
                             double tolerance) {
  if (!estimate || estimate->poses.empty()) {
    return std::nullopt;
  }
  try {
    EvaluationOptions options;
    options.tolerance = tolerance;
    options.across_parts = true;
    return evaluate(*estimate, truth, options).ate.rmse;
  } catch (const InputError&) {  // nothing matches, or all is in one place
    return std::nullopt;
  }
}

std::string text_of(const LoopAte& ate) {
  const auto text = [](const std::optional<double>& error) {
    return error ? fmt::format("{:.3f} m", *error) : "unknown";
  };
  return "odometry " + text(ate.odometry) + ", map " + text(ate.map);
}

Json json_of(const std::optional<double>& error) {
  return error ? Json(*error) : Json();
}

}  // namespace

LoopEffect loop_effect(const std::filesystem::path& odometry, const std::filesystem::path& map,
                       const Trajectory& truth, const std::optional<LoopSpan>& span,
                       double tolerance) {
  const std::optional<Trajectory> before = trajectory_in(odometry);
  const std::optional<Trajectory> after = trajectory_in(map);
  LoopEffect effect{.all = {.odometry = ate_of(before, truth, tolerance),
                            .map = ate_of(after, truth, tolerance)}};
  if (span) {
    const auto part = [&](const std::optional<Trajectory>& all) {
      return all ? std::optional(within(*all, *span)) : std::nullopt;
    };
    effect.in_span = {.odometry = ate_of(part(before), truth, tolerance),
                      .map = ate_of(part(after), truth, tolerance)};
    effect.span_path = path_between(truth, span->begin, span->end);
  }
  return effect;
}

RunLoops evaluate_loops(const std::filesystem::path& folder, const Trajectory& truth,
                        const std::filesystem::path& loops, double tolerance) {
  const RunFiles files(folder);
  const std::vector<TrueLoop> pairs = read_true_loops(loops);
  check_true_loops(loops, pairs, truth);
  RunLoops result{.score = score_loops(files.database, truth, pairs), .effect = {}};
  result.effect = loop_effect(files.odometry, files.tum, truth, result.score.span, tolerance);
  return result;
}

std::string describe(const RunLoops& loops) {
  std::string text = describe(loops.score) + "ATE          " + text_of(loops.effect.all) + "\n";
  if (const std::optional<LoopSpan>& span = loops.score.span) {
    text += fmt::format(
        "             between the ends of right loops, {:.1f} s and {:.1f} m, aligned alone: {}\n",
        seconds(span->end - span->begin), loops.effect.span_path, text_of(loops.effect.in_span));
  }
  return text;
}

Json to_json(const RunLoops& loops) {
  Json json = to_json(loops.score);
  json["ate_odometry_m"] = json_of(loops.effect.all.odometry);
  json["ate_map_m"] = json_of(loops.effect.all.map);
  json["span"] = Json();
  if (const std::optional<LoopSpan>& span = loops.score.span) {
    json["span"] = {{"begin_s", seconds(span->begin)},
                    {"end_s", seconds(span->end)},
                    {"path_m", loops.effect.span_path},
                    {"ate_odometry_m", json_of(loops.effect.in_span.odometry)},
                    {"ate_map_m", json_of(loops.effect.in_span.map)}};
  }
  return json;
}

}  // namespace adit
