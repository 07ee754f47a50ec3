// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/shown_run.hpp"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

bool is_file(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(path, unknown);
}

fs::path map_of(const fs::path& what) {
  std::error_code unknown;
  if (!fs::is_directory(what, unknown)) {
    if (what.extension() != ".adit") {
      throw InputError(what, {},
                       fs::exists(what, unknown)
                           ? "it is neither the folder of a run nor a map (.adit)"
                           : "there is no such folder or file",
                       "A recording is mapped first: adit run RECORDING -o OUT, then adit convert "
                       "OUT run.mcap --as foxglove");
    }
    return what;
  }
  const RunFiles files(what);
  if (is_file(files.database)) {
    return files.database;
  }
  if (!is_file(files.tum)) {
    throw InputError(what, {}, "it holds neither map.adit nor trajectory.tum",
                     "Expected the folder OUT that `adit run RECORDING -o OUT` leaves");
  }
  return {};
}

std::string word_at(const json& object, const char* pointer) {
  const json::json_pointer at(pointer);
  return object.is_object() && object.contains(at) && object[at].is_string()
             ? object[at].get<std::string>()
             : "";
}

ShownLevel level_of_trust(const std::string& trust) {
  return trust == "lost"       ? ShownLevel::error
         : trust == "doubtful" ? ShownLevel::warning
                               : ShownLevel::info;
}

/// What the run says of itself, at the times it says that of.
std::vector<ShownEvent> verdict_events(const json& summary, Nanoseconds start) {
  std::vector<ShownEvent> events;
  const std::string verdict = word_at(summary, "/verdict/state");
  if (verdict.empty()) {
    return events;
  }
  events.push_back(
      {.stamp = start, .level = level_of_trust(verdict), .text = "the run is " + verdict});
  const json reasons = summary["verdict"].value("reasons", json::array());
  for (const json& reason : reasons) {
    if (const std::string text = word_at(reason, "/text"); !text.empty()) {
      events.push_back(
          {.stamp = start, .level = level_of_trust(word_at(reason, "/state")), .text = text});
    }
  }
  const json stretches = summary["verdict"].value("stretches", json::array());
  for (const json& stretch : stretches) {
    const std::string text = word_at(stretch, "/text");
    if (!text.empty() && stretch.contains("begin_s") && stretch["begin_s"].is_number()) {
      events.push_back({.stamp = start + nanoseconds(stretch["begin_s"].get<double>()),
                        .level = level_of_trust(word_at(stretch, "/state")),
                        .text = text});
    }
  }
  return events;
}

void read_map(ShownRun& run) {
  const MapDatabase map(run.map, MapAccess::read);
  run.keyframes = map.keyframes();
  run.poses = map_trajectory(map, run.map);
  run.parts = map_parts(map, run.map);
  run.events = loop_events(map);
  run.fixes = map.fixes();
  std::erase_if(run.fixes, [](const MapFix& fix) { return fix.verdict == FixVerdict::impossible; });
  run.georeference = map.georeference();
}

/// What a run's folder has besides a map.
void read_folder(ShownRun& run, const fs::path& folder) {
  const RunFiles files(folder);
  if (is_file(files.sweeps)) {
    run.sweeps = read_sweep_table(files.sweeps);
  }
  const json summary =
      is_file(files.summary) ? json::parse(read_text_file(files.summary), nullptr, false) : json();
  run.recording = word_at(summary, "/input/path");
  const std::vector<ShownEvent> verdict = run.sweeps.empty()
                                              ? std::vector<ShownEvent>()
                                              : verdict_events(summary, run.sweeps.front().stamp);
  run.events.insert(run.events.begin(), verdict.begin(), verdict.end());
}

}  // namespace

ShownRun read_shown_run(const fs::path& what) {
  ShownRun run;
  run.map = map_of(what);
  const RunFiles files(what);
  if (!run.map.empty()) {
    read_map(run);
  } else {
    Trajectory trajectory = read_trajectory(files.tum);
    run.poses = std::move(trajectory.poses);
    run.parts = std::move(trajectory.parts);
    run.cloud = is_file(files.map) ? files.map : fs::path();
  }
  if (run.map != what) {
    read_folder(run, what);
  }
  if (run.poses.empty() && run.sweeps.empty()) {
    throw InputError(what, {}, "it holds no sweep yet",
                     "Wait until `adit run` has placed one, or map the recording again");
  }
  return run;
}

}  // namespace adit
