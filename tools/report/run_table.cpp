// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/run_summary.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/core.h>

#include "adit/tools/report/gnss_text.hpp"
#include "adit/tools/report/localization_text.hpp"
#include "adit/tools/report/loop_reasons.hpp"
#include "adit/tools/report/measurement_faults_text.hpp"
#include "adit/tools/report/verdict_text.hpp"
#include "adit/tools/setup/device_session.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/shell_word.hpp"

namespace adit {
namespace {

constexpr std::size_t kIndent = 9;  // indent of what follows a row's name

std::string counts(const RunStatistics& statistics) {
  const std::size_t failed = statistics.failures().size();
  std::string text = fmt::format("{} placed, {} failed", statistics.sweeps() - failed, failed);
  const std::size_t coasting = statistics.count(OdometryState::coasting);
  const std::size_t restarted = statistics.count(OdometryState::restarted);
  if (failed > 0) {
    text += fmt::format(" ({} bridged by the predicted motion, {} new starts; see summary.json)",
                        coasting, restarted);
  }
  if (restarted > 0) {
    text += "; how the pieces before and after a new start lie to each other is a guess";
  }
  text += fmt::format(", {} keyframes", statistics.keyframes());
  if (statistics.lost_points() > 0) {
    text += fmt::format("; {} points found no place on the device", statistics.lost_points());
  }
  if (statistics.crowded_voxels() > 0) {
    text += fmt::format(
        "; {} times a voxel of the submap held more than 65535 points, and their mean is lost: a "
        "smaller registration.r_align keeps it",
        statistics.crowded_voxels());
  }
  return text;
}

std::string host_times(const RunStatistics& statistics, bool makes_map) {
  const auto mean = [&](std::string_view stage) {
    return distribution(std::ranges::find(statistics.host_stages(), stage, &StageTimes::stage)->ms)
        .mean;
  };
  std::string text = fmt::format(
      "{:.1f} ms a sweep: waiting for the reader {:.1f}, host {:.1f}, waiting for the device "
      "{:.1f}",
      mean("total"), mean("read_wait"), mean("host"), mean("wait"));
  text += makes_map ? fmt::format(", map {:.1f}", mean("map")) : "";
  text += fmt::format(", write {:.1f}; the reader itself {:.1f}, beside these", mean("write"),
                      mean("read"));
  if (!statistics.device_stages().empty()) {
    text += fmt::format("; {:.1f} by the device's own clock",
                        distribution(statistics.device_stages().back().ms).mean);
  }
  return text;
}

/// What semicolons part, a row each; not within brackets.
std::string as_rows(const std::string& text) {
  std::string rows;
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    depth += text[i] == '(' ? 1 : (text[i] == ')' ? -1 : 0);
    const bool ends = depth == 0 && text.compare(i, 2, "; ") == 0;
    rows += ends ? "\n" + std::string(kIndent, ' ') : std::string(1, text[i]);
    i += ends ? 1 : 0;
  }
  return rows;
}

/// How the IMU was used; in a brief report without what it was compared by.
std::string inertial_text(const RunStatistics& statistics, bool brief) {
  std::string text = statistics.inertial().text();
  if (brief) {
    const std::size_t compared = text.find("; against the sweeps");
    const std::size_t next =
        compared == std::string::npos ? compared : text.find("; ", compared + 2);
    return compared == std::string::npos
               ? text
               : text.substr(0, compared) + (next == std::string::npos ? "" : text.substr(next));
  }
  const Distribution times = distribution(statistics.inertial_stage().ms);
  if (times.count > 0) {
    text += fmt::format("; preintegration and graph {:.2f} ms a sweep, {:.2f} at most", times.mean,
                        times.max);
  }
  return text;
}

/// What is wrong with a map, each behind a semicolon.
std::string map_faults_text(const MapReport& map) {
  std::string text;
  if (map.components > 1) {
    text += fmt::format("; {} parts that nothing ties together", map.components);
  }
  if (map.lost_points > 0) {
    text += fmt::format("; {} points too far from their keyframe", map.lost_points);
  }
  if (map.crowded_cells > 0) {
    text += fmt::format(
        "; {} cells held more than 65535 points, and their mean is lost: a smaller "
        "mapping.r_submap keeps it",
        map.crowded_cells);
  }
  if (map.outgrown) {
    text += fmt::format(
        "; from keyframe {} on the graph has outgrown --max-ram: no loops were looked for, "
        "fixes moved nothing, and it did not end with an optimisation, which `adit optimize` makes "
        "up for",
        *map.outgrown);
  }
  return text;
}

std::string map_text(const MapReport& map, double wall_s) {
  const Distribution times = distribution(map.keyframe_ms);
  std::string text = fmt::format("{} keyframes, {} edges, {} of them with their submaps aligned",
                                 map.keyframes, map.edges, map.aligned_edges);
  if (map.seen_through > 0) {
    text += fmt::format("; {} of {} points were seen through: what they were of has moved",
                        map.seen_through, map.points);
  }
  text += map_faults_text(map);
  text += fmt::format("; {:.1f} ms a keyframe, {:.1f} at most", times.mean, times.max);
  return text +
         fmt::format("; sweeps waited {:.1f} s for it, {:.0f} % of the run, one of them {:.2f} s",
                     map.waited_s, wall_s > 0.0 ? 100.0 * map.waited_s / wall_s : 0.0,
                     map.longest_wait_s);
}

std::string loops_text(const LoopReport& loops) {
  std::string text = fmt::format("{} accepted of {} candidates", loops.accepted, loops.candidates);
  if (loops.by_appearance > 0) {
    text +=
        fmt::format("; by appearance {} of {}", loops.accepted_by_appearance, loops.by_appearance);
  }
  if (loops.without_vertical > 0) {
    text += fmt::format("; {} keyframes without a vertical, not known by appearance",
                        loops.without_vertical);
  }
  const std::string refused = reasons_text(loops.refused);
  const Distribution times = distribution(loops.search_ms);
  if (loops.farthest_from_odometry) {
    text +=
        fmt::format("; up to {:.2f} m from the odometry, {:.1f} of its standard deviations",
                    loops.farthest_from_odometry->metres, loops.farthest_from_odometry->sigmas());
  }
  return text + (refused.empty() ? "" : "; refused: " + refused) +
         fmt::format("; corrected by up to {:.2f} m; {:.1f} ms a keyframe, {:.1f} at most",
                     loops.largest_correction, times.mean, times.max);
}

std::string stage_table(const RunStatistics& statistics) {
  std::string text = "\n  ms a sweep                  sweeps     mean      p50      p95      max\n";
  const auto row = [&](const char* where, const StageTimes& stage) {
    const Distribution d = distribution(stage.ms);
    text += fmt::format("  {:<6} {:<18} {:7}  {:>7.3f}  {:>7.3f}  {:>7.3f}  {:>7.3f}\n", where,
                        stage.stage, d.count, d.mean, d.p50, d.p95, d.max);
  };
  for (const StageTimes& stage : statistics.host_stages()) {
    row(stage.stage == "read" ? "reader" : "host", stage);
  }
  if (!statistics.inertial_stage().ms.empty()) {
    row("host", statistics.inertial_stage());
  }
  for (const StageTimes& stage : statistics.device_stages()) {
    row("device", stage);
  }
  text += "\n  given to the device a sweep sweeps     mean      p50      p95      max\n";
  for (const WorkCounts& kind : counts_by_kind(statistics.device_work())) {
    const Distribution d = distribution(kind.counts);
    text += fmt::format("  {:<25} {:7}  {:>7.1f}  {:>7.0f}  {:>7.0f}  {:>7.0f}\n", kind.name,
                        d.count, d.mean, d.p50, d.p95, d.max);
  }
  return text;
}

double in_mebibytes(uint64_t bytes) {
  return static_cast<double>(bytes) / (1024.0 * 1024.0);
}

std::string limit_text(uint64_t bytes, const char* option) {
  return bytes == 0 ? std::string()
                    : fmt::format(" of {:.0f} MiB ({})", in_mebibytes(bytes), option);
}

/// The files in one line, and what to do next.
std::string brief_files_text(const RunDescription& run, const RunOutcome& outcome) {
  const RunFiles files(run.output);
  std::string text = "wrote    " + (outcome.result.map ? files.database : files.tum).string();
  const auto add = [&](const std::filesystem::path& file) {
    text += ", " + file.filename().string();
  };
  if (outcome.result.map) {
    add(files.tum);
  }
  add(files.kitti);
  add(files.sweeps);
  if (run.map.enabled) {
    add(files.map);
  }
  if (outcome.high_rate) {
    add(HighRateFiles(run.output).tum);
    text += " (" + describe(*outcome.high_rate) + ")";
    add(HighRateFiles(run.output).csv);
  }
  add(files.page);
  add(files.summary);
  return text + "\nnext     adit view " + shell_word(run.output.string()) + "\n";
}

std::string files_text(const RunDescription& run, const RunOutcome& outcome) {
  const RunFiles files(run.output);
  std::string text = "wrote    " +
                     (outcome.result.map ? files.database.string() + "\n         " : "") +
                     files.tum.string() + "\n         " + files.kitti.string() + "\n         " +
                     files.sweeps.string() + "\n";
  if (run.map.enabled) {
    text += "         " + files.map.string() + fmt::format(" ({} points)\n", outcome.map_points);
  }
  if (outcome.high_rate) {
    text += "         " + HighRateFiles(run.output).tum.string() + " (" +
            describe(*outcome.high_rate) + ")\n         " + HighRateFiles(run.output).csv.string() +
            " (velocities, covariances)\n";
  }
  text += "         " + files.page.string() + " (the map, in a browser)\n";
  text += "         " + files.summary.string() + "\n";
  return text;
}

std::string path_text(const RunDescription& run, const RunOutcome& outcome,
                      const RunStatistics& statistics) {
  const double rate =
      outcome.wall_s > 0.0 ? static_cast<double>(statistics.sweeps()) / outcome.wall_s : 0.0;
  return fmt::format("path     {:.1f} m, {} of {} sweeps in {} ({:.1f} sweeps/s)\n",
                     statistics.distance(), statistics.sweeps(), run.range.count,
                     format_duration(outcome.wall_s), rate);
}

/// What was wrong with the recording.
std::string faults_text(const RunOutcome& outcome, const RunStatistics& statistics) {
  std::string text;
  if (statistics.left_out().any()) {
    text += "left out " + statistics.left_out().text() + "\n";
  }
  for (const std::string& fault : describe(outcome.result.faults)) {
    text += "values   " + fault + "\n";
  }
  if (statistics.left_out().put_in_order() > 0) {
    text += "order    " + statistics.left_out().order_text() + "\n";
  }
  return text;
}

/// What other sensors than lidar and IMU came to.
std::string further_sensors_text(const RunOutcome& outcome, const RunStatistics& statistics) {
  std::string text;
  for (const std::string& line : statistics.velocity().text()) {
    text += "velocity " + as_rows(line) + "\n";
  }
  if (!outcome.result.map) {
    return text;
  }
  const MapReport& map = *outcome.result.map;
  if (map.localization.any()) {
    text += "in map   " + describe(map.localization) + "\n";
  }
  if (map.gnss.any()) {
    text += "gnss     " + as_rows(describe(map.gnss)) + "\n";
    const std::string antenna = describe_antenna(map.gnss);
    text += antenna.empty() ? "" : "antenna  " + as_rows(antenna) + "\n";
    const std::string heading = describe(map.gnss.heading);
    text += heading.empty() ? "" : "heading  " + as_rows(heading) + "\n";
  }
  return text;
}

/// Of the map in a line or two; in a brief report without times and reasons.
std::string map_rows(const RunOutcome& outcome, bool brief) {
  if (!outcome.result.map) {
    return {};
  }
  const MapReport& map = *outcome.result.map;
  std::string text;
  if (brief) {
    text += "map      " +
            as_rows(fmt::format("{} keyframes, {} points", map.keyframes, map.points) +
                    map_faults_text(map)) +
            "\n";
  } else {
    text += "map      " + as_rows(map_text(map, outcome.wall_s)) + "\n";
  }
  if (map.loops) {
    text += "loops    " +
            (brief ? fmt::format(
                         "{} accepted of {} candidates, the map corrected by up to {:.2f} m",
                         map.loops->accepted, map.loops->candidates, map.loops->largest_correction)
                   : loops_text(*map.loops)) +
            "\n";
  }
  return text;
}

/// Lengths in force, times, device and memory: for whoever wants to know why a run is slow, or what
/// was chosen.
std::string means_text(const RunDescription& run, const RunOutcome& outcome,
                       const RunStatistics& statistics) {
  std::string text = fmt::format(
      "voxels   one point per {:.3g} m, submap {:.3g} m, returns within {:.3g} m\n",
      run.config.preprocess.r_input, run.config.registration.r_align, run.config.preprocess.c_max);
  text += "time     " + as_rows(host_times(statistics, outcome.result.map.has_value())) + "\n";
  text += "device   " + describe(run.device) +
          fmt::format("; ready in {:.1f} s, {:.1f} MiB at most", outcome.start_s,
                      in_mebibytes(outcome.device_peak_bytes)) +
          limit_text(run.memory_budget_bytes, "--max-vram") + "\n";
  return text +
         fmt::format("memory   {:.0f} MiB resident at most",
                     in_mebibytes(outcome.resident_peak_bytes)) +
         limit_text(run.max_ram_bytes, "--max-ram") + "\n";
}

}  // namespace

std::string summary_table(const RunDescription& run, const RunOutcome& outcome,
                          const RunStatistics& statistics, RunDetail detail) {
  const bool brief = detail == RunDetail::brief;
  std::string text;
  if (const auto start = statistics.first_stamp()) {
    text += "verdict  " + describe(assess_run(run, outcome, statistics), *start, kIndent) + "\n";
  }
  text += path_text(run, outcome, statistics);
  if (!brief || !statistics.failures().empty() || statistics.lost_points() > 0 ||
      statistics.crowded_voxels() > 0) {
    text += "sweeps   " + counts(statistics) + "\n";
  }
  text += faults_text(outcome, statistics);
  if (statistics.inertial().any()) {
    text += "imu      " + as_rows(inertial_text(statistics, brief)) + "\n";
  }
  text += map_rows(outcome, brief) + further_sensors_text(outcome, statistics);
  if (const std::string shares = describe_shares(run_sources(run, outcome, statistics));
      !shares.empty()) {
    text += "sources  " + as_rows(shares) + "\n";
  }
  text += brief ? "" : means_text(run, outcome, statistics);
  if (run.kept) {
    text += brief ? brief_files_text(run, outcome) : files_text(run, outcome);
  }
  return detail == RunDetail::stages ? text + stage_table(statistics) : text;
}

}  // namespace adit
