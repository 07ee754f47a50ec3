// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_job.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "adit/tools/map_database/writer_lock.hpp"
#include "adit/tools/report/run_assessment.hpp"
#include "adit/tools/report/run_statistics.hpp"
#include "adit/tools/report/run_summary.hpp"
#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/run/prepared_run.hpp"
#include "adit/tools/run/run_judgement.hpp"
#include "adit/tools/run/run_map.hpp"
#include "adit/tools/run/run_map_page.hpp"
#include "adit/tools/run/run_mapping.hpp"
#include "adit/tools/run/run_rehearsal.hpp"
#include "adit/tools/run/run_settings.hpp"
#include "adit/tools/run/run_view.hpp"
#include "adit/tools/run/wanted_run.hpp"
#include "adit/tools/setup/configured_recording.hpp"
#include "adit/tools/setup/memory_limit.hpp"
#include "adit/tools/setup/sensor_topics.hpp"
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

// A map that closes loops must never hold up the poses of a sensor that goes on.
constexpr std::size_t kMostBehindLive = std::numeric_limits<std::size_t>::max();

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

/// Throws OutputError where one of the files could not be written.
void require_writable(const RunCommandOptions& options, const Config& config) {
  const RunFiles files(options.output);
  std::vector<std::filesystem::path> others;
  if (options.high_rate.enabled) {
    const HighRateFiles high_rate(options.output);
    others = {high_rate.tum, high_rate.csv};
  }
  if (options.timeline) {
    others.push_back(*options.timeline);
  }
  if (config.mapping.enabled) {
    others.insert(others.end(), {files.odometry, files.database});
  }
  check_writable(options.output, options.map, others);
}

/// The device; null where a signal came while its programs were compiled.
std::unique_ptr<DeviceSession> open_device(const RunCommandOptions& options, std::ostream& err) {
  DeviceOptions wanted = options.device;
  wanted.notes = options.quiet ? nullptr : &err;
  try {
    auto session = std::make_unique<DeviceSession>(wanted);
    if (session->context().software_fallback() && !options.quiet) {
      err << software_note(session->context().device()) << std::endl;
    }
    return session;
  } catch (const StoppedWhileCompiling& stopped) {
    err << "adit run: " << stopped.what() << std::endl;
    return nullptr;
  }
}

/// Says what is mapped, and how.
void say_beginning(const RunDescription& description, const PreparedRun& run,
                   const RunCommandOptions& options, std::ostream& err) {
  say_detail(err, "recording: " + description.recording_description + "; its sweeps are on " +
                      description.topic);
  say_detail(err, "settings: " + describe(options.config));
  err << notes_of(*run.source.known) << as_notes(notes_of(run.sensors));
}

/// What a run writes to, and what its Slam needs for it.
struct JobOutputs {
  RunDescription description;
  MemoryLimit memory;
  SlamOptions slam{};
  std::unique_ptr<RunMap> map{};  ///< null: odometry alone
  std::unique_ptr<RunOutputs> files{};
  std::unique_ptr<HighRateOutput> high_rate{};  ///< null: not asked for
};

/// Begins the folder's files, and the map or the rest of it. An earlier run's results are removed
/// once the sweeps of this one are seen to be readable.
JobOutputs open_outputs(const WantedRun& chosen, const PreparedRun& run, engine::Context& context,
                        std::ostream& err) {
  const RunCommandOptions& options = chosen.options;
  const std::optional<EarlierRun>& continued = chosen.continued;
  const bool maps = run.config.mapping.enabled;
  JobOutputs outputs{
      .description = describe_run(options, run.config, *run.source.known, run.sweeps, context),
      .memory = MemoryLimit(options.max_ram_bytes,
                            working_bytes(run.config.mapping, run.most_points), maps)};
  if (!options.quiet) {
    say_beginning(outputs.description, run, options, err);
  }
  outputs.slam = {.inertial = run.sensors.imu.has_value(),
                  .map_memory = outputs.memory.map_memory(),
                  .placed = run.source.placed};
  if (run.source.endless) {
    outputs.slam.most_behind = kMostBehindLive;
  }
  uint64_t& graph_bytes = outputs.slam.map_memory.graph_bytes;
  if (continued) {  // so that it makes the same map
    graph_bytes = continued->graph_bytes.value_or(MapMemory{}.graph_bytes);
  }
  if (graph_bytes != MapMemory{}.graph_bytes) {
    outputs.description.graph_bytes = graph_bytes;
  }
  if (continued) {
    outputs.map =
        std::make_unique<RunMap>(outputs.description, session_of(outputs.description), *continued);
    if (!options.quiet) {
      err << "note: what " << continued->map.string()
          << " holds is done again and compared; from where it ends it grows\n";
    }
  } else {
    require_free_map(options.output);
  }
  if (run.map_use && run.map_use->extends) {
    require_new_recording(*run.map_use, session_of(outputs.description));
  }
  if (run.replaces_a_run) {
    rehearse(*run.source.known, run.sweeps.topic, run.sweeps.range, run.config, context);
  }
  // The summary first: from here on the folder tells of this run, whatever ends it.
  replace_text_file(
      RunFiles(options.output).summary,
      with_room(running_summary(outputs.description).dump(2, ' ', false, kReplaceBadText) + "\n"));
  if (run.replaces_a_run) {
    remove_earlier_run(options.output, continued ? EarlierMap::keep : EarlierMap::remove);
  }
  if (maps) {
    if (run.map_use) {
      outputs.map = std::make_unique<RunMap>(outputs.description, session_of(outputs.description),
                                             *run.map_use);
      outputs.slam.earlier_sessions = run.map_use->earlier_sessions();
      outputs.slam.start = run.map_use->start;
    } else if (!outputs.map) {
      outputs.map = std::make_unique<RunMap>(outputs.description, session_of(outputs.description));
    }
    outputs.slam.map = &outputs.map->store();
    outputs.slam.session = outputs.map->session();
  }
  outputs.files = std::make_unique<RunOutputs>(options.output, options.map, maps);
  if (options.high_rate.enabled) {
    outputs.high_rate = std::make_unique<HighRateOutput>(options.output);
    outputs.slam.high_rate_smoothing = options.high_rate.smoothing;
  }
  return outputs;
}

std::unique_ptr<Slam> begin_slam(const PreparedRun& run, const SlamOptions& options,
                                 engine::Context& context) {
  std::unique_ptr<Slam> slam = make_slam(context, run.config, options);
  for (const StaticTransform& transform : run.sensors.transforms.transforms) {
    slam->add(transform);
  }
  return slam;
}

/// What mapping has come to.
struct MappedRun {
  RunOutcome outcome;
  RunTimeline timeline{};
  Config config;  ///< in force
  std::optional<Mounting> mounting{};
};

/// Maps the sweeps into the outputs until the source or a signal ends the run.
MappedRun map(const RunCommandOptions& options, const PreparedRun& run, JobOutputs& outputs,
              std::unique_ptr<Slam> slam, RunStatistics& statistics, Progress& progress,
              RunView* view) {
  MappedRun mapped;
  std::function<void(const InputError&)> damaged;
  if (!options.strict_input) {
    damaged = [&](const InputError& error) {
      const auto note = statistics.left_out().add_damage(error, outputs.description.topic);
      if (note && !options.quiet) {
        progress.note(*note);
      }
    };
  }
  const auto placed = [&](const SweepPlaced& sweep) {
    if (run.source.mapped) {
      run.source.mapped(sweep);
    }
    if (view != nullptr) {
      view->add(sweep, statistics,
                run.sweeps.counted ? run.sweeps.range.count : statistics.sweeps());
    }
  };
  mapped.outcome =
      map_sweeps({.recording = *run.merged,
                  .topic = run.sweeps.topic,
                  .range = run.sweeps.range,
                  .path = options.recording,
                  .imu_topic = run.sensors.imu,
                  .gnss_topic = run.gnss,
                  .velocity_topic = run.sensors.velocity,
                  .heading_topic = run.config.mapping.enabled ? run.sensors.heading : std::nullopt,
                  .slam = *slam,
                  .stop = [&] { return !run.source.ends_by_itself && StopSignal::received() != 0; },
                  .damaged = damaged,
                  .memory = &outputs.memory,
                  .outputs = *outputs.files,
                  .high_rate = outputs.high_rate.get(),
                  .statistics = statistics,
                  .timeline = options.timeline ? &mapped.timeline : nullptr,
                  .placed = placed,
                  .progress = progress,
                  .quiet = options.quiet});
  for (const auto& [topic, count] : run.merged->counts()) {
    mapped.outcome.lidars.push_back(
        {.topic = topic, .sweeps = count.merged, .of = statistics.sweeps()});
  }
  mapped.mounting = slam->mounting();
  mapped.config = with_mounting(slam->config(), mapped.mounting);
  if (view != nullptr) {
    const RunAssessment assessment = assess_run(outputs.description, mapped.outcome, statistics);
    view->end_mapping(mapped.outcome, statistics, assessment.trust);
  }
  return mapped;
}

/// Writes the files that come last, the verdict and the summary. Returns the exit code.
int complete(const RunCommandOptions& options, const PreparedRun& run, const JobOutputs& outputs,
             const MappedRun& mapped, const RunStatistics& statistics, std::ostream& out,
             std::ostream& err) {
  RunDescription description = outputs.description;
  description.config = mapped.config;
  if (!options.quiet) {
    err << notes_of(run.config, description.config, mapped.mounting)
        << as_notes(run.mapped->notes()) << as_notes(run.merged->notes());
  }
  const RunOutcome& outcome = mapped.outcome;
  if (!run.sweeps.counted) {
    const bool whole = run.source.endless || outcome.result.end == RunEnd::completed;
    description.range.count = std::max(
        statistics.sweeps(), whole ? 0 : std::min(run.sweeps.size, run.sweeps.range.count));
    description.recording_sweeps = run.sweeps.range.first + description.range.count;
  }
  const int judged = judge_run(outcome, statistics, description, err);
  const Trust trust = assess_run(description, outcome, statistics).trust;
  if (!options.quiet && statistics.sweeps() > 0) {
    say_detail(err, "verdict: " + std::string(to_string(trust)));
  }
  const int code = options.strict ? judge_strictly(judged, trust, statistics, err) : judged;
  const std::string summary =
      final_summary(description, outcome, statistics).dump(2, ' ', false, kReplaceBadText) + "\n";
  // Before the report, which a closed pipe may end.
  replace_text_file(RunFiles(options.output).summary, summary);
  if (outputs.map && outcome.result.map && outcome.result.end == RunEnd::completed) {
    outputs.map->set_complete();  // last of all: there is nothing left to go on with
  }
  if (options.json) {
    out << summary << std::flush;
  } else if (!options.quiet && statistics.sweeps() > 0) {
    const RunDetail detail = options.stage_table  ? RunDetail::stages
                             : shows_details(err) ? RunDetail::whole
                                                  : RunDetail::brief;
    out << summary_table(description, outcome, statistics, detail) << std::flush;
  }
  return code;
}

}  // namespace

int run_job(const WantedRun& chosen, const OpenSource& open, RunView* view, std::ostream& out,
            std::ostream& err) {
  const RunCommandOptions& options = chosen.options;
  const PreparedRun run = prepare(chosen, open, err);
  make_output_folder(options.output);
  const WriterLock lock(
      RunFiles(options.output).summary);  // two runs would leave a mixture of both
  require_writable(options, run.config);
  if (view != nullptr) {
    view->say_link();
  }
  const auto started = std::chrono::steady_clock::now();
  const std::unique_ptr<DeviceSession> session = open_device(options, err);
  if (!session) {
    return 128 + StopSignal::received();
  }
  engine::Context& context = session->context();
  JobOutputs outputs = open_outputs(chosen, run, context, err);
  if (view != nullptr && outputs.map) {
    view->show_map(RunFiles(options.output).database);
  }
  std::unique_ptr<Slam> slam = begin_slam(run, outputs.slam, context);
  const double start_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  RunStatistics statistics(run.config);
  Progress progress(err, options.quiet ? ProgressStyle::none : progress_style_of_stderr(),
                    "mapping", run.sweeps.counted ? run.sweeps.range.count : kUnknownTotal);
  if (view != nullptr) {
    view->set_doing("mapping");
  }
  if (run.source.begun) {
    run.source.begun(
        {.mapped = *run.merged,
         .imu = run.sensors.imu,
         .config = run.config,
         .map = outputs.map ? std::optional(RunFiles(options.output).database) : std::nullopt});
  }
  MappedRun mapped = map(options, run, outputs, std::move(slam), statistics, progress, view);
  if (run.source.ended) {
    run.source.ended(mapped.outcome.result);
  }
  release_free_memory();  // the Slam's is needed for the files that come last
  mapped.outcome =
      with_complete_files(std::move(mapped.outcome), *outputs.files, outputs.high_rate.get(),
                          outputs.map.get(), outputs.description, statistics.sweeps());
  if (options.timeline) {
    mapped.outcome = with_timeline(std::move(mapped.outcome), mapped.timeline, *options.timeline,
                                   outputs.description);
  }
  progress.finish();
  if (run.source.report) {
    mapped.outcome.live = run.source.report();
  }
  mapped.outcome.start_s = start_s;
  mapped.outcome.device_peak_bytes = context.memory_peak();
  mapped.outcome.resident_peak_bytes = peak_resident_bytes();
  mapped.outcome.validation_messages = context.validation_messages();
  return complete(options, run, outputs, mapped, statistics, out, err);
}

}  // namespace adit
