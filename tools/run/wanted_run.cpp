// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/wanted_run.hpp"

#include <system_error>
#include <utility>

#include "adit/tools/containers/rosbag2_metadata.hpp"
#include "adit/tools/report/run_timeline.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

void check_options(const RunCommandOptions& options) {
  const MapOptions& map = options.map;
  if (map.resolution && !(*map.resolution >= 1e-3 && *map.resolution <= 1e3)) {
    throw UsageError("--map-resolution: must be between 0.001 and 1000 m.");
  }
  if (map.resolution && !map.enabled) {
    throw UsageError("--map-resolution and --no-map exclude each other.");
  }
  const HighRateOptions& high_rate = options.high_rate;
  if (!(high_rate.smoothing >= 0.0 && high_rate.smoothing <= 10.0)) {
    throw UsageError("--high-rate-smoothing: must be between 0 and 10 s.");
  }
  if (high_rate.smoothing > 0.0 && !high_rate.enabled) {
    throw UsageError("--high-rate-smoothing needs --high-rate.");
  }
  if (options.timeline) {
    require_timeline_name(*options.timeline);
  }
  if (options.odometry) {
    for (const std::string& setting : options.config.overrides) {
      if (setting.starts_with("mapping.enabled=")) {
        throw UsageError("--odometry and --set " + setting + " exclude each other.");
      }
    }
  }
  if (!options.view && options.serve != ServeOptions{}) {
    throw UsageError("--port, --listen and --foxglove need --view.");
  }
  if (options.start.value_or(0) < 0 || options.count.value_or(1) < 1) {
    throw UsageError("--start must be at least 0, --count at least 1.");
  }
}

/// The map that --continue goes on with.
EarlierRun run_to_continue(const RunCommandOptions& options) {
  const ConfigSource& config = options.config;
  if (options.odometry || options.overwrite) {
    throw UsageError(std::string("--continue and ") +
                     (options.odometry ? "--odometry" : "--overwrite") + " exclude each other.");
  }
  if (options.from || config.file || !config.preset.empty() || !config.overrides.empty() ||
      options.topic || !options.merged_topics.empty() || options.start || options.count) {
    throw UsageError(
        "--continue goes on with the settings and the sweeps that the map was begun with; leave "
        "out what chooses others. --from MAP maps the recording of a map with other settings.");
  }
  const std::filesystem::path map = RunFiles(options.output).database;
  std::error_code unknown;
  if (!std::filesystem::exists(map, unknown)) {
    throw UsageError("--continue: " + options.output.string() +
                     " holds no map.adit to go on with. Leave it out to begin one.");
  }
  EarlierRun earlier = earlier_run(map);
  if (!earlier.progress.complete && earlier.progress.edited) {
    throw InputError(map, {},
                     "it was made by an older adit, or written to since its run (by adit loops, "
                     "optimize or recover)",
                     "To go on with it would undo that; map anew into another folder");
  }
  return earlier;
}

/// With the recording that the map says it is of, unless another one is named.
RunCommandOptions with_recording(RunCommandOptions options, const EarlierRun& earlier) {
  if (!options.recording.empty()) {
    return options;
  }
  options.recording = earlier.recording;
  options.further_recordings = earlier.further_recordings;
  for (const std::filesystem::path& one : recordings_of(options)) {
    std::error_code unknown;
    if (!std::filesystem::exists(one, unknown)) {
      throw InputError(earlier.map, {}, "its recording " + one.string() + " is not there",
                       "Name it: adit run RECORDING ...");
    }
  }
  return options;
}

/// A folder of rosbag2 by its metadata.yaml is the folder. Several recordings are all there.
RunCommandOptions with_folders(RunCommandOptions options) {
  options.recording = without_metadata_file(options.recording);
  for (std::filesystem::path& one : options.further_recordings) {
    one = without_metadata_file(one);
    std::error_code unknown;
    if (!std::filesystem::exists(one, unknown)) {
      throw UsageError("RECORDING " + one.string() +
                       ": there is no such file or folder. The folder for the results is named "
                       "with -o: -o " +
                       one.string() + ".");
    }
  }
  return options;
}

/// The earlier run's settings. What tells of the sensor may lie elsewhere now.
KeptConfig kept(const RunCommandOptions& options, const EarlierRun& earlier, const Config& config) {
  const std::optional<std::string>& metadata = config.recording.metadata;
  std::error_code unknown;
  if (metadata && !options.config.metadata && !std::filesystem::exists(*metadata, unknown)) {
    throw InputError(earlier.map, {}, "what told of its sensor, " + *metadata + ", is not there",
                     "Name it: --metadata FILE");
  }
  return {.origin = earlier.map, .toml = to_toml(config)};
}

/// As the earlier run was.
RunCommandOptions continuing(RunCommandOptions options, const EarlierRun& earlier) {
  options = with_recording(std::move(options), earlier);
  options.config.kept =
      kept(options, earlier, parse_config(earlier.session.configuration, earlier.map));
  options.topic = earlier.topic;
  options.start = earlier.first_sweep;
  options.count = earlier.sweeps;
  return options;
}

/// With the settings of the map, and of its recording the same sweeps, where nothing else is said.
RunCommandOptions repeating(RunCommandOptions options, const EarlierRun& earlier) {
  Config config = parse_config(earlier.session.configuration, earlier.map);
  if (options.recording.empty()) {
    config.recording.sweep_topic = earlier.topic;
    if (!options.start && !options.count) {
      options.start = earlier.first_sweep;
      options.count = earlier.sweeps;
    }
  }
  options = with_recording(std::move(options), earlier);
  if (!is_recording_of(earlier.session, recordings_of(options))) {
    throw InputError(options.recording, {},
                     "it is not what " + earlier.map.string() + " was made of, by its content",
                     "Name that recording; to map this one alike, give it the settings with "
                     "--config (summary.json has them)");
  }
  options.config.kept = kept(options, earlier, config);
  return options;
}

/// The options with the folder and the settings that they imply.
RunCommandOptions completed(RunCommandOptions options) {
  if (options.output.empty()) {
    if (options.recording.empty()) {
      throw UsageError(options.continues ? "--continue: name the folder of the run with -o OUT."
                                         : "RECORDING is missing: name a file or a folder to map.");
    }
    options.output = default_output(options.recording);
  }
  if (options.odometry) {
    options.config.overrides.emplace_back("mapping.enabled=false");
  }
  return options;
}

WantedRun wanted(const RunCommandOptions& given) {
  if (given.continues) {
    const EarlierRun earlier = run_to_continue(given);
    return {.options = earlier.progress.complete ? given : continuing(given, earlier),
            .continued = earlier};
  }
  if (given.from) {
    if (same_file(*given.from, RunFiles(given.output).database)) {
      throw UsageError("-o " + given.output.string() + ": the new map would replace " +
                       given.from->string() + ", which it is made from. Name another folder.");
    }
    return {.options = repeating(given, earlier_run(*given.from)), .continued = {}};
  }
  if (given.recording.empty()) {
    throw UsageError("RECORDING is missing: name a file or a folder to map.");
  }
  return {.options = given, .continued = {}};
}

}  // namespace

std::vector<std::filesystem::path> recordings_of(const RunCommandOptions& options) {
  std::vector<std::filesystem::path> all = {options.recording};
  all.insert(all.end(), options.further_recordings.begin(), options.further_recordings.end());
  return all;
}

void take_recordings(RunCommandOptions& options, const std::vector<std::filesystem::path>& all) {
  if (!all.empty()) {
    options.recording = all.front();
    options.further_recordings.assign(all.begin() + 1, all.end());
  }
}

bool check_output_folder(const RunCommandOptions& options) {
  bool holds_a_run = false;
  for (const std::filesystem::path& one : recordings_of(options)) {
    holds_a_run = check_output_folder(one, options.output);
  }
  return holds_a_run;
}

std::filesystem::path default_output(const std::filesystem::path& recording) {
  const std::filesystem::path whole =
      (std::filesystem::absolute(recording) / "").lexically_normal().parent_path();
  std::error_code unknown;
  const bool folder = std::filesystem::is_directory(whole, unknown);
  std::filesystem::path name = folder ? whole.filename() : whole.stem();
  if (std::filesystem::exists(name, unknown) &&
      (!std::filesystem::is_directory(name, unknown) || same_file(name, whole))) {
    name += "-out";
  }
  return std::filesystem::path(".") / name;
}

WantedRun wanted_run(const RunCommandOptions& given) {
  check_options(given);
  return wanted(completed(with_folders(given)));
}

}  // namespace adit
