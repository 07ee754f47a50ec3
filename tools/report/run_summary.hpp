// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit run` tells at its end: summary.json for programs, a table for people.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/engine/device_info.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/tools/report/run_end.hpp"
#include "adit/tools/report/run_statistics.hpp"
#include "adit/tools/report/source_table.hpp"
#include "adit/tools/results/high_rate_output.hpp"
#include "adit/tools/results/run_outputs.hpp"

namespace adit {

/// What is known before the first sweep.
struct RunDescription {
  std::filesystem::path recording;
  std::vector<std::filesystem::path> further_recordings{};  ///< parts of it that follow in time
  std::string recording_description;
  std::string topic;  ///< the sweeps'
  std::size_t recording_sweeps = 0;
  bool times_are_assumed = false;
  SweepRange range;
  std::filesystem::path output;
  MapOptions map;
  HighRateOptions high_rate;
  Config config;
  engine::DeviceInfo device;
  std::string device_requested;  ///< empty: nothing was asked for
  bool software_fallback = false;
  uint64_t memory_budget_bytes = 0;  ///< of the device; 0: no limit
  uint64_t max_ram_bytes = 0;        ///< that may be resident; 0: no limit
  /// MapMemory::graph_bytes; none: no limit. A run that goes on has that of the one before.
  std::optional<uint64_t> graph_bytes{};
  bool validation = false;
  bool continued = false;  ///< an earlier run's map is gone on with
  bool kept = true;        ///< false: its folder goes away in the end
};

/// What a live run reports besides.
struct LiveReport {
  double latency_p50_ms = 0.0;  ///< from the arrival of a sweep's last point to its pose
  double latency_p99_ms = 0.0;
  std::size_t sweeps = 0;          ///< whose latency is known
  uint64_t lost_datagrams = 0;     ///< dropped by the kernel: its buffer was full
  uint64_t unknown_datagrams = 0;  ///< of no known sensor: neither used nor recorded
  /// From the arrival of an inertial reading to the pose that was published of it.
  double high_rate_age_p50_ms = 0.0;
  double high_rate_age_p99_ms = 0.0;
  std::size_t high_rate_poses = 0;  ///< published
  bool recording_is_whole = true;   ///< false: it stops where the disk was nearly full
};

/// What is known after the last.
struct RunOutcome {
  MappingResult result;
  double start_s = 0.0;  ///< before: the device and its kernels made ready
  double wall_s =
      0.0;  ///< s, mapping alone, from the first sweep's reading to the last one's writing
  uint64_t map_points = 0;
  uint64_t device_peak_bytes = 0;
  uint64_t resident_peak_bytes = 0;             ///< of the process; 0: not told
  std::optional<HighRateStatistics> high_rate;  ///< none: not asked for
  std::vector<std::string> validation_messages;
  std::optional<LiveReport> live{};   ///< of `adit live`
  std::vector<MergedLidar> lidars{};  ///< empty: there is one range sensor
};

/// All sources of the run.
std::vector<SourceWorth> run_sources(const RunDescription& run, const RunOutcome& outcome,
                                     const RunStatistics& statistics);

/// summary.json as it stands while the run goes on: its status is "running". A process that is
/// killed leaves this.
nlohmann::ordered_json running_summary(const RunDescription& run);

/// summary.json of a run that has ended.
nlohmann::ordered_json final_summary(const RunDescription& run, const RunOutcome& outcome,
                                     const RunStatistics& statistics);

/// How much the report of a run says.
enum class RunDetail {
  brief,   ///< what came of it, in eight lines, and what was wrong
  whole,   ///< and how: settings, times, device, memory
  stages,  ///< and a table of every stage's time
};

/// The same for people.
std::string summary_table(const RunDescription& run, const RunOutcome& outcome,
                          const RunStatistics& statistics, RunDetail detail);

}  // namespace adit
