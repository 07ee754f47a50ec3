// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/run_summary.hpp"

#include "adit/tools/report/verdict_text.hpp"

#include <nlohmann/json.hpp>

#include "adit/tools/report/gnss_text.hpp"
#include "adit/tools/report/localization_text.hpp"
#include "adit/tools/report/loop_reasons.hpp"
#include "adit/tools/report/measurement_faults_text.hpp"
#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/setup/device_session.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

ordered_json describe_run(const RunDescription& run, std::string_view status,
                          const std::string& reason) {
  ordered_json json;
  json["adit"] = version();
  json["schema"] = "summary/1";  // docs/schemas
  json["status"] = status;
  json["reason"] = reason;
  json["input"] = {{"path", run.recording.string()}, {"description", run.recording_description},
                   {"sweeps", run.recording_sweeps}, {"times_are_assumed", run.times_are_assumed},
                   {"first", run.range.first},       {"count", run.range.count}};
  for (const std::filesystem::path& one : run.further_recordings) {
    json["input"]["further_paths"].push_back(one.string());
  }
  json["device"] = to_json(run.device);
  json["device"]["requested"] = run.device_requested;
  json["device"]["software_fallback"] = run.software_fallback;
  json["device"]["memory_budget_bytes"] = run.memory_budget_bytes;
  json["continued"] = run.continued;
  json["configuration"] = to_json(run.config);
  return json;
}

ordered_json describe_sweeps(const RunStatistics& statistics) {
  ordered_json json;
  json["processed"] = statistics.sweeps();
  json["failed"] = statistics.failures().size();
  json["keyframes"] = statistics.keyframes();
  json["lost_points"] = statistics.lost_points();
  json["crowded_voxels"] = statistics.crowded_voxels();
  for (const OdometryState state : kOdometryStates) {
    json["states"][std::string(to_string(state))] = statistics.count(state);
  }
  for (const RegistrationStatus status : kRegistrationStatuses) {
    json["registrations"][std::string(to_string(status))] = statistics.count(status);
  }
  json["failures"] = ordered_json::array();
  for (const SweepFailure& failure : statistics.failures()) {
    json["failures"].push_back({{"index", failure.index},
                                {"source", failure.source},
                                {"state", to_string(failure.state)},
                                {"registration", to_string(failure.status)},
                                {"reason", failure.reason}});
  }
  return json;
}

ordered_json describe_values(const std::vector<float>& values) {
  const Distribution times = distribution(values);
  return {{"sweeps", times.count},
          {"mean", times.mean},
          {"p50", times.p50},
          {"p95", times.p95},
          {"max", times.max}};
}

ordered_json describe_stage(const StageTimes& stage) {
  return describe_values(stage.ms);
}

template <class Stages>
ordered_json describe_stages(const Stages& stages) {
  ordered_json json = ordered_json::object();
  for (const StageTimes& stage : stages) {
    json[stage.stage] = describe_stage(stage);
  }
  return json;
}

ordered_json describe_work(const std::vector<engine::RecordedWork>& sweeps) {
  ordered_json json = ordered_json::object();
  for (const WorkCounts& kind : counts_by_kind(sweeps)) {
    json[kind.name] = describe_values(kind.counts);
  }
  return json;
}

ordered_json describe_outputs(const RunDescription& run, const RunOutcome& outcome) {
  const RunFiles files(run.output);
  ordered_json json = {{"folder", run.output.string()},
                       {"files",
                        {files.tum.filename().string(), files.kitti.filename().string(),
                         files.sweeps.filename().string()}}};
  if (run.map.enabled) {
    json["files"].push_back(files.map.filename().string());
    json["map_points"] = outcome.map_points;
    json["map_resolution_m"] =
        run.map.resolution ? ordered_json(*run.map.resolution) : ordered_json();
  }
  if (run.config.mapping.enabled) {
    json["files"].push_back(files.odometry.filename().string());
    json["files"].push_back(files.database.filename().string());
  }
  if (outcome.high_rate) {
    const HighRateFiles high_rate(run.output);
    json["files"].push_back(high_rate.tum.filename().string());
    json["files"].push_back(high_rate.csv.filename().string());
    json["high_rate"] = to_json(*outcome.high_rate);
    json["high_rate"]["smoothing_s"] = run.high_rate.smoothing;
  }
  return json;
}

ordered_json farthest_json(const std::optional<LoopMove>& move) {
  return move ? ordered_json{{"distance_m", move->metres},
                             {"turn_rad", move->radians},
                             {"chi2", move->chi2},
                             {"sigmas", move->sigmas()},
                             {"path_m", move->path}}
              : ordered_json();
}

ordered_json describe_loops(const LoopReport& loops) {
  const Distribution times = distribution(loops.search_ms);
  return {{"candidates", loops.candidates},
          {"accepted", loops.accepted},
          {"by_appearance",
           {{"candidates", loops.by_appearance}, {"accepted", loops.accepted_by_appearance}}},
          {"keyframes_without_vertical", loops.without_vertical},
          {"refused", reasons_to_json(loops.refused)},
          {"optimizations", loops.optimizations},
          {"largest_correction_m", loops.largest_correction},
          {"farthest_from_odometry", farthest_json(loops.farthest_from_odometry)},
          {"keyframe_ms",
           {{"mean", times.mean}, {"p50", times.p50}, {"p95", times.p95}, {"max", times.max}}}};
}

ordered_json describe_map(const MapReport& map) {
  const Distribution times = distribution(map.keyframe_ms);
  ordered_json json = {
      {"keyframes", map.keyframes},
      {"sweeps", map.sweeps},
      {"edges", map.edges},
      {"aligned_edges", map.aligned_edges},
      {"components", map.components},
      {"points", map.points},
      {"seen_through_points", map.seen_through},
      {"lost_points", map.lost_points},
      {"crowded_cells", map.crowded_cells},
      {"outgrown_keyframe", map.outgrown ? ordered_json(*map.outgrown) : ordered_json()},
      {"waited_s", map.waited_s},
      {"longest_wait_s", map.longest_wait_s},
      {"keyframe_ms",
       {{"mean", times.mean}, {"p50", times.p50}, {"p95", times.p95}, {"max", times.max}}}};
  if (map.loops) {
    json["loops"] = describe_loops(*map.loops);
  }
  if (map.localization.any()) {
    json["localization"] = to_json(map.localization);
  }
  if (map.gnss.any()) {
    json["gnss"] = to_json(map.gnss);
  }
  return json;
}

double rate(const RunOutcome& outcome, const RunStatistics& statistics) {
  return outcome.wall_s > 0.0 ? static_cast<double>(statistics.sweeps()) / outcome.wall_s : 0.0;
}

}  // namespace

std::vector<SourceWorth> run_sources(const RunDescription& run, const RunOutcome& outcome,
                                     const RunStatistics& statistics) {
  std::vector<SourceWorth> sources = motion_sources(statistics, outcome.lidars);
  if (outcome.result.map) {
    for (SourceWorth& one : map_sources(*outcome.result.map, run.config)) {
      sources.push_back(std::move(one));
    }
  }
  return sources;
}

ordered_json running_summary(const RunDescription& run) {
  return describe_run(run, "running",
                      "the run has not ended, or was killed: the files hold what it had by then");
}

ordered_json final_summary(const RunDescription& run, const RunOutcome& outcome,
                           const RunStatistics& statistics) {
  ordered_json json = describe_run(run, to_string(outcome.result.end), outcome.result.reason);
  json["device"]["memory_peak_bytes"] = outcome.device_peak_bytes;
  json["memory"] = {{"max_ram_bytes", run.max_ram_bytes},
                    {"resident_peak_bytes", outcome.resident_peak_bytes}};
  const Eigen::Vector3d& offset = statistics.coordinate_offset();
  json["input"]["coordinate_offset_m"] = {offset.x(), offset.y(), offset.z()};
  json["sweeps"] = describe_sweeps(statistics);
  json["sweeps"]["deskewed"] = statistics.deskewed();
  if (const auto start = statistics.first_stamp()) {
    json["verdict"] = to_json(assess_run(run, outcome, statistics), *start);
  }
  json["left_out"] = statistics.left_out().to_json();
  json["not_finite"] = to_json(outcome.result.faults);
  if (statistics.inertial().any()) {
    json["imu"] = statistics.inertial().to_json();
    json["imu"]["host_ms"] = describe_stage(statistics.inertial_stage());
  }
  if (statistics.velocity().any()) {
    json["velocity"] = statistics.velocity().to_json();
  }
  if (outcome.result.map) {
    json["map"] = describe_map(*outcome.result.map);
  }
  json["sources"] = to_json(run_sources(run, outcome, statistics));
  json["distance_m"] = statistics.distance();
  json["time"] = {{"start_s", outcome.start_s},
                  {"wall_s", outcome.wall_s},
                  {"recorded_s", statistics.recorded_seconds()},
                  {"sweeps_per_s", rate(outcome, statistics)},
                  {"host_ms", describe_stages(statistics.host_stages())},
                  {"device_ms", describe_stages(statistics.device_stages())},
                  {"device_work", describe_work(statistics.device_work())}};
  if (outcome.live) {
    json["live"] = {{"latency_p50_ms", outcome.live->latency_p50_ms},
                    {"latency_p99_ms", outcome.live->latency_p99_ms},
                    {"sweeps", outcome.live->sweeps},
                    {"lost_datagrams", outcome.live->lost_datagrams},
                    {"unknown_datagrams", outcome.live->unknown_datagrams},
                    {"high_rate_age_p50_ms", outcome.live->high_rate_age_p50_ms},
                    {"high_rate_age_p99_ms", outcome.live->high_rate_age_p99_ms},
                    {"high_rate_poses", outcome.live->high_rate_poses},
                    {"recording_is_whole", outcome.live->recording_is_whole}};
  }
  json["output"] = describe_outputs(run, outcome);
  if (outcome.result.map && outcome.result.map->localization.any()) {
    json["output"]["files"].push_back(RunFiles(run.output).localization.filename().string());
  }
  json["validation"] = {{"enabled", run.validation}, {"messages", outcome.validation_messages}};
  return json;
}

}  // namespace adit
