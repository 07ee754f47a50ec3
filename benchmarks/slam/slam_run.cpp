// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/slam/slam_run.hpp"

#include <exception>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/tools/evaluation/evaluation_plot.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit::bench {
namespace {

using namespace nlohmann::literals;

constexpr double kStretch = 10.0;  // m

/// What a command complained of, without its name, up to the first line's end.
std::string complaint(const std::string& text) {
  const std::string line = text.substr(0, text.find('\n'));
  constexpr std::string_view kHead = "adit run: ";
  return line.starts_with(kHead) ? line.substr(kHead.size()) : line;
}

SlamEffort effort_of(const nlohmann::json& summary) {
  const auto& sweeps = summary.at("sweeps");
  const std::size_t processed = sweeps.at("processed");
  return {.sweeps = processed,
          .placed = processed - sweeps.at("failed").get<std::size_t>(),
          .ms_a_sweep = summary.at("time").at("host_ms").at("total").at("mean"),
          .sweeps_a_second = summary.at("time").at("sweeps_per_s")};
}

/// The errors and the drawing of a trajectory; why there are none, if so.
SlamResult compare(const SlamSequence& sequence, const std::string& system,
                   const std::filesystem::path& trajectory) {
  const EvaluationOptions options{
      .rpe = {.delta = kStretch, .pairs_from = PairSource::truth, .from_first_pose = true},
      .across_parts = true};  // what a new start costs counts
  const Evaluation found = evaluate(read_trajectory(trajectory), truth_of(sequence), options);
  const Statistics& stretches = found.rpe.translation;
  return {
      .errors = SlamErrors{.ate = found.ate.rmse,
                           .ate_largest = found.ate.max,
                           .ate_rotation = found.ate_rotation.rmse,
                           .drift = stretches.count > 0 ? std::optional(stretches.mean / kStretch)
                                                        : std::nullopt,
                           .path = found.association.truth_path,
                           .covered = found.association.covered_path},
      .drawing = html_drawing([&](double width) {
        return plot_evaluation(found, system + " on " + sequence.name, width);
      })};
}

/// A file that cannot be read or matched is a failure.
template <class Judge>
SlamResult judged_by_truth(const Judge& judge) {
  try {
    return judge();
  } catch (const InputError& error) {
    return {.verdict = SlamVerdict::failed, .why = error.what()};
  }
}

}  // namespace

SlamResult map_sequence(const SlamSequence& sequence, const SlamVariant& variant,
                        const DeviceOptions& device, const std::filesystem::path& folder) {
  RunCommandOptions run;
  run.recording = sequence.recording;
  run.output = folder;
  run.config = variant.config;
  // First, so that others may say otherwise.
  std::vector<std::string>& settings = run.config.overrides;
  settings.insert(settings.begin(), sequence.settings.begin(), sequence.settings.end());
  if (!sequence.loops) {
    settings.insert(settings.begin(), "mapping.enabled=false");
  }
  run.overwrite = true;
  run.device = device;
  run.map.enabled = false;
  run.json = true;
  run.quiet = true;
  std::ostringstream summary;
  std::ostringstream complaints;
  const int code = run_command(run, summary, complaints);
  if (code == 2) {
    throw UsageError(complaint(complaints.str()));
  }
  if (code > 128) {
    throw std::runtime_error("stopped by a signal; recordings made so far are kept");
  }
  SlamResult result;
  if (!summary.str().empty()) {
    const auto told = nlohmann::json::parse(summary.str());
    result = judged_by_truth([&] {
      SlamResult found = compare(sequence, variant.name, RunFiles(folder).tum);
      found.loops = loops_of_run(sequence, folder, told);
      return found;
    });
    result.effort = effort_of(told);
    result.trust = told.value("/verdict/state"_json_pointer, "");
  }
  if (code != 0) {
    result.verdict = SlamVerdict::failed;
    result.why = complaint(complaints.str());
  }
  return result;
}

SlamResult judge_system(const SlamSequence& sequence, const std::filesystem::path& system) {
  const std::filesystem::path trajectory = file_of(system, sequence);
  if (!std::filesystem::exists(trajectory)) {
    return {};
  }
  return judged_by_truth([&] {
    SlamResult found = compare(sequence, system.filename().string(), trajectory);
    if (sequence.loops) {
      found.loops = loops_of_system(sequence, system);
    }
    return found;
  });
}

}  // namespace adit::bench
