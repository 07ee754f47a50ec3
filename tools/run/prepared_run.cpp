// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/prepared_run.hpp"

#include <algorithm>
#include <ostream>
#include <string>

#include <nlohmann/json.hpp>

#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/run/run_settings.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

SweepChoice choose_sweeps(const RunSource& source, const RunCommandOptions& options,
                          const RecordingConfig& config) {
  const Recording& recording = *source.known;
  const std::size_t topic =
      sweep_topic(recording, options.recording, options.topic ? options.topic : config.sweep_topic);
  const auto size = static_cast<std::size_t>(recording.topics()[topic].messages.value_or(0));
  if (source.endless) {
    return {.topic = topic, .size = size, .range = {.count = kUnknownTotal}, .counted = false};
  }
  const auto start = static_cast<std::size_t>(options.start.value_or(0));
  if (size == 0) {
    throw InputError(options.recording, {},
                     recording.topics()[topic].name + " holds no whole sweep",
                     "`adit inspect` tells what is in it");
  }
  if (start >= size) {
    throw UsageError("--start " + std::to_string(start) + ": the recording has the sweeps 0 to " +
                     std::to_string(size - 1) + ".");
  }
  if (!config.further_sweep_topics.empty()) {  // merged: how many they make is known in the end
    const auto count = static_cast<std::size_t>(options.count.value_or(kUnknownTotal));
    return {.topic = topic,
            .size = size,
            .range = {.first = start, .count = std::min(count, kUnknownTotal)},
            .counted = false};
  }
  const std::size_t rest = size - start;
  const std::size_t count = options.count ? static_cast<std::size_t>(*options.count) : rest;
  return {.topic = topic, .size = size, .range = {.first = start, .count = std::min(count, rest)}};
}

/// --merge is a setting as well: poses of its topics may be among the others.
ConfigSource config_of(const RunCommandOptions& options) {
  ConfigSource source = options.config;
  if (!options.merged_topics.empty()) {
    source.overrides.push_back("recording.further_sweep_topics=" +
                               nlohmann::json(options.merged_topics).dump());
  }
  return source;
}

}  // namespace

PreparedRun prepare(const WantedRun& chosen, const OpenSource& open, std::ostream& err) {
  const RunCommandOptions& options = chosen.options;
  PreparedRun run;
  // A map that is gone on with shows that the folder is a run's.
  run.replaces_a_run = chosen.continued.has_value() || check_output_folder(options);
  if (!chosen.continued && !options.overwrite) {
    require_no_results(options.output);
  }
  run.config = load_config(config_of(options));
  run.map_use = map_use(options, run.config);
  run.source = open(run.config);
  const Recording& recording = *run.source.known;
  if (run.config.imu.wait == ImuConfig{}.wait) {  // not stated: as when it arrived
    run.config.imu.wait = recording.recorded_wait().value_or(run.config.imu.wait);
  }
  require_packets(options.config, options.recording);
  run.sweeps = choose_sweeps(run.source, options, run.config.recording);
  run.sensors = choose_sensors(recording, run.sweeps.topic, run.config);
  const OneSensorRecording known(recording, run.sensors.frames);
  for (const MergedTopic& one : run.sensors.sweeps) {
    run.most_points += require_clear_point_times(known, one.topic, options.recording);
  }
  run.mapped = std::make_unique<OneSensorRecording>(
      run.source.arriving ? *run.source.arriving : recording, run.sensors.frames);
  run.merged =
      std::make_unique<MergedRecording>(*run.mapped, run.sensors.sweeps, options.recording);
  if (run.config.mapping.enabled) {
    run.gnss = run.sensors.gnss;
  } else if (run.sensors.gnss && !options.quiet) {
    err << kFixesAreLeftOut;
  }
  return run;
}

}  // namespace adit
