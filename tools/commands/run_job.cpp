// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/run_job.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "adit/tools/commands/run_judgement.hpp"
#include "adit/tools/commands/run_rehearsal.hpp"
#include "adit/tools/commands/run_settings.hpp"
#include "adit/tools/commands/run_view.hpp"
#include "adit/tools/commands/wanted_run.hpp"
#include "adit/tools/map_database/writer_lock.hpp"
#include "adit/tools/recordings/one_sensor.hpp"
#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/run/configured_recording.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/run/memory_limit.hpp"
#include "adit/tools/run/run_assessment.hpp"
#include "adit/tools/run/run_map.hpp"
#include "adit/tools/run/run_map_page.hpp"
#include "adit/tools/run/run_mapping.hpp"
#include "adit/tools/run/run_statistics.hpp"
#include "adit/tools/run/run_summary.hpp"
#include "adit/tools/run/sensor_topics.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/message_buffer.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/resident_memory.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

// A file name need not be UTF-8, JSON must be.
constexpr auto kReplaceBadText = nlohmann::ordered_json::error_handler_t::replace;

/// The sweeps to map, and where they come from.
struct SweepChoice {
  std::size_t topic = 0;
  std::size_t size = 0;  ///< sweeps in the recording
  SweepRange range;
};

SweepChoice choose_sweeps(const RunSource& source, const RunCommandOptions& options,
                          const std::optional<std::string>& name) {
  const Recording& recording = *source.known;
  const std::size_t topic = sweep_topic(recording, options.recording, name);
  const auto size = static_cast<std::size_t>(recording.topics()[topic].messages.value_or(0));
  const auto start = static_cast<std::size_t>(options.start.value_or(0));
  if (size == 0) {
    throw InputError(options.recording, {},
                     recording.topics()[topic].name + " holds no whole sweep",
                     "`adit inspect` tells what is in it");
  }
  if (source.endless) {
    return {.topic = topic, .size = size, .range = {.first = 0, .count = kUnknownTotal}};
  }
  if (start >= size) {
    throw UsageError("--start " + std::to_string(start) + ": the recording has the sweeps 0 to " +
                     std::to_string(size - 1) + ".");
  }
  const std::size_t rest = size - start;
  const std::size_t count = options.count ? static_cast<std::size_t>(*options.count) : rest;
  return {.topic = topic, .size = size, .range = {.first = start, .count = std::min(count, rest)}};
}

RunDescription describe_run(const RunCommandOptions& options, const Config& config,
                            const Recording& recording, const SweepChoice& sweeps,
                            const engine::Context& context) {
  return {.recording = options.recording,
          .further_recordings = options.further_recordings,
          .recording_description = recording.description(),
          .topic = recording.topics()[sweeps.topic].name,
          .recording_sweeps = sweeps.size,
          .times_are_assumed = recording.times_are_assumed(),
          .range = sweeps.range,
          .output = options.output,
          .map = options.map,
          .high_rate = options.high_rate,
          .config = config,
          .device = context.device(),
          .device_requested = requested_device(options.device.device),
          .software_fallback = context.software_fallback(),
          .memory_budget_bytes = options.device.max_vram_bytes,
          .max_ram_bytes = options.max_ram_bytes,
          .validation = options.device.validation,
          .continued = options.continues,
          .kept = options.keeps};
}

/// The text with blanks behind it, as long as the summary of most runs: on a disk that is full in
/// the end there is room for that one.
std::string with_room(std::string text) {
  constexpr std::size_t kRoom = 16 << 10;
  text.append(kRoom - std::min(kRoom, text.size()), ' ');
  return text;
}

RunOutcome map_sweeps(const Mapping& mapping) {
  RunOutcome outcome;
  const auto start = std::chrono::steady_clock::now();
  outcome.result = map_recording(mapping);
  outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return outcome;
}

/// Closes the files and writes those that come last. A failure to complete one of them counts as
/// the end of the run unless it had ended before.
RunOutcome with_complete_files(RunOutcome outcome, RunOutputs& outputs, HighRateOutput* high_rate,
                               const RunMap* map, const RunDescription& run, std::size_t sweeps) {
  try {
    outputs.close();
    if (high_rate != nullptr) {
      high_rate->close();
    }
    if (outcome.result.map) {
      map->write_final(outputs.map_parts());
    }
    if (sweeps > 0) {
      write_map_page(RunFiles(run.output), outputs.page_cloud(), run.recording.filename().string());
    }
  } catch (const std::exception& error) {
    if (outcome.result.end == RunEnd::completed) {
      outcome.result.end = end_of(error);
      outcome.result.reason = error.what();
    }
  }
  outcome.map_points = outputs.map_points();
  if (high_rate != nullptr) {
    outcome.high_rate = high_rate->statistics();
  }
  return outcome;
}

/// Writes the timeline, also of a run that ended early. A failure to is the end of a run that was
/// complete.
RunOutcome with_timeline(RunOutcome outcome, const RunTimeline& timeline,
                         const std::filesystem::path& file, const RunDescription& run) {
  try {
    write_timeline(timeline, file, "Timeline of " + run.recording.filename().string());
  } catch (const OutputError& error) {
    if (outcome.result.end == RunEnd::completed) {
      outcome.result.end = RunEnd::output_error;
      outcome.result.reason = error.what();
    }
  }
  return outcome;
}

}  // namespace

int run_job(const WantedRun& chosen, const OpenSource& open, RunView* view, std::ostream& out,
            std::ostream& err) {
  const RunCommandOptions& options = chosen.options;
  const std::optional<EarlierRun>& continued = chosen.continued;
  // A map that is gone on with shows that the folder is a run's.
  const bool replaces_a_run = continued.has_value() || check_output_folder(options);
  if (!continued && !options.overwrite) {
    require_no_results(options.output);
  }
  const Config config = load_config(options.config);
  const RunSource source = open(config);
  const Recording* recording = source.known.get();
  require_packets(options.config, options.recording);
  const SweepChoice sweeps =
      choose_sweeps(source, options, options.topic ? options.topic : config.recording.sweep_topic);
  const RecordedSensors sensors = choose_sensors(*recording, sweeps.topic, config);
  const OneSensorRecording known(*recording, sensors.frames);
  const std::size_t most_points = require_clear_point_times(known, sweeps.topic, options.recording);
  const OneSensorRecording mapped(source.arriving ? *source.arriving : *recording, sensors.frames);
  const std::optional<std::size_t> gnss = config.mapping.enabled ? sensors.gnss : std::nullopt;
  if (sensors.gnss && !gnss && !options.quiet) {
    err << kFixesAreLeftOut;
  }
  const HighRateFiles high_rate_files(options.output);
  std::vector<std::filesystem::path> others;
  if (options.high_rate.enabled) {
    others = {high_rate_files.tum, high_rate_files.csv};
  }
  if (options.timeline) {
    others.push_back(*options.timeline);
  }
  const RunFiles files(options.output);
  if (config.mapping.enabled) {
    others.insert(others.end(), {files.odometry, files.database});
  }
  make_output_folder(options.output);
  const WriterLock lock(files.summary);  // two runs would leave a mixture of both
  check_writable(options.output, options.map, others);
  if (view != nullptr) {
    view->say_link();
  }
  const auto started = std::chrono::steady_clock::now();
  DeviceOptions device_options = options.device;
  device_options.notes = options.quiet ? nullptr : &err;
  std::optional<DeviceSession> session;
  try {
    session.emplace(device_options);
  } catch (const StoppedWhileCompiling& stopped) {
    err << "adit run: " << stopped.what() << std::endl;
    return 128 + StopSignal::received();
  }
  engine::Context& context = session->context();
  if (context.software_fallback() && !options.quiet) {
    err << software_note(context.device()) << std::endl;
  }
  RunDescription description = describe_run(options, config, *recording, sweeps, context);
  if (!options.quiet) {
    say_detail(err, "recording: " + description.recording_description + "; its sweeps are on " +
                        description.topic);
    say_detail(err, "settings: " + describe(options.config));
    err << notes_of(*recording) << as_notes(notes_of(sensors));
  }
  const MemoryLimit memory(options.max_ram_bytes, working_bytes(config.mapping, most_points),
                           config.mapping.enabled);
  SlamOptions wanted{.inertial = sensors.imu.has_value(), .map_memory = memory.map_memory()};
  if (continued) {  // so that it makes the same map
    wanted.map_memory.graph_bytes = continued->graph_bytes.value_or(MapMemory{}.graph_bytes);
  }
  if (wanted.map_memory.graph_bytes != MapMemory{}.graph_bytes) {
    description.graph_bytes = wanted.map_memory.graph_bytes;
  }

  std::optional<MapSession> origin;
  if (config.mapping.enabled) {
    origin = session_of(description);
  }
  std::optional<RunMap> map;
  if (continued) {
    map.emplace(description, *origin, *continued);
    if (!options.quiet) {
      err << "note: what " << continued->map.string()
          << " holds is done again and compared; from where it ends it grows\n";
    }
  } else {
    require_free_map(options.output);
  }
  if (replaces_a_run) {
    rehearse(*recording, sweeps.topic, sweeps.range, config, context);
  }
  // The summary first: from here on the folder tells of this run, whatever ends it.
  replace_text_file(
      files.summary,
      with_room(running_summary(description).dump(2, ' ', false, kReplaceBadText) + "\n"));
  if (replaces_a_run) {
    remove_earlier_run(options.output, continued ? EarlierMap::keep : EarlierMap::remove);
  }
  if (config.mapping.enabled) {
    if (!map) {
      map.emplace(description, *origin);
    }
    wanted.map = &map->store();
    wanted.session = map->session();
    if (view != nullptr) {
      view->show_map(files.database);
    }
  }
  RunOutputs outputs(options.output, options.map, map.has_value());
  std::optional<HighRateOutput> high_rate;
  if (options.high_rate.enabled) {
    high_rate.emplace(options.output);
    wanted.high_rate_smoothing = options.high_rate.smoothing;
  }
  std::unique_ptr<Slam> slam = make_slam(context, config, wanted);
  for (const StaticTransform& transform : sensors.transforms.transforms) {
    slam->add(transform);
  }
  const double start_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  RunStatistics statistics(config);
  Progress progress(err, options.quiet ? ProgressStyle::none : progress_style_of_stderr(),
                    "mapping", source.endless ? kUnknownTotal : sweeps.range.count);
  std::function<void(const InputError&)> damaged;
  if (!options.strict_input) {
    damaged = [&](const InputError& error) {
      const auto note = statistics.left_out().add_damage(error, description.topic);
      if (note && !options.quiet) {
        progress.note(*note);
      }
    };
  }
  RunTimeline timeline;
  if (view != nullptr) {
    view->set_doing("mapping");
  }
  const auto placed = [&](const SweepPlaced& sweep) {
    if (source.placed) {
      source.placed(sweep);
    }
    if (view != nullptr) {
      view->add(sweep, statistics, source.endless ? statistics.sweeps() : sweeps.range.count);
    }
  };
  RunOutcome outcome =
      map_sweeps({.recording = mapped,
                  .topic = sweeps.topic,
                  .range = sweeps.range,
                  .imu_topic = sensors.imu,
                  .gnss_topic = gnss,
                  .slam = *slam,
                  .stop = [&] { return !source.ends_by_itself && StopSignal::received() != 0; },
                  .damaged = damaged,
                  .memory = &memory,
                  .outputs = outputs,
                  .high_rate = high_rate ? &*high_rate : nullptr,
                  .statistics = statistics,
                  .timeline = options.timeline ? &timeline : nullptr,
                  .placed = placed,
                  .progress = progress,
                  .quiet = options.quiet});
  if (view != nullptr) {
    const RunAssessment assessment = assess_run(description, outcome, statistics);
    view->end_mapping(outcome, statistics, assessment.trust);
  }
  const std::optional<Mounting> mounting = slam->mounting();
  description.config = with_mounting(slam->config(), mounting);
  slam.reset();  // its memory is needed for the files that come last
  release_free_memory();
  outcome = with_complete_files(std::move(outcome), outputs, high_rate ? &*high_rate : nullptr,
                                map ? &*map : nullptr, description, statistics.sweeps());
  if (options.timeline) {
    outcome = with_timeline(std::move(outcome), timeline, *options.timeline, description);
  }
  progress.finish();
  if (!options.quiet) {
    err << notes_of(config, description.config, mounting) << as_notes(mapped.notes());
  }
  if (source.endless) {
    description.range.count = statistics.sweeps();
    description.recording_sweeps = statistics.sweeps();
  }
  if (source.report) {
    outcome.live = source.report();
  }
  outcome.start_s = start_s;
  outcome.device_peak_bytes = context.memory_peak();
  outcome.resident_peak_bytes = peak_resident_bytes();
  outcome.validation_messages = context.validation_messages();

  const int judged = judge_run(outcome, statistics, description, err);
  const Trust trust = assess_run(description, outcome, statistics).trust;
  if (!options.quiet && statistics.sweeps() > 0) {
    say_detail(err, "verdict: " + std::string(to_string(trust)));
  }
  const int code = options.strict ? judge_strictly(judged, trust, statistics, err) : judged;
  const std::string summary =
      final_summary(description, outcome, statistics).dump(2, ' ', false, kReplaceBadText) + "\n";
  replace_text_file(files.summary, summary);  // before the report, which a closed pipe may end
  if (map && outcome.result.map && outcome.result.end == RunEnd::completed) {
    map->set_complete();  // last of all: there is nothing left to go on with
  }
  if (options.json) {
    out << summary << std::flush;
  } else if (!options.quiet && statistics.sweeps() > 0) {
    out << summary_table(description, outcome, statistics, options.stage_table) << std::flush;
  }
  return code;
}

}  // namespace adit
