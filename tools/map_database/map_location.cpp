// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/map_location.hpp"

#include <optional>
#include <string>
#include <system_error>

#include <nlohmann/json.hpp>

#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kHowToMake = "`adit run RECORDING -o OUT` makes the map OUT/map.adit";

/// What summary.json says of a run.
struct RunSummary {
  std::string recording;  ///< empty: unknown
  bool maps = true;       ///< the run was to make a map
};

/// Nothing where the folder is no run's.
std::optional<RunSummary> summary_in(const fs::path& folder) {
  const fs::path file = RunFiles(folder).summary;
  std::error_code unknown;
  if (!fs::is_regular_file(file, unknown)) {
    return std::nullopt;
  }
  const json summary = json::parse(read_text_file(file), nullptr, false);
  const auto at = [&](const char* pointer) {
    const json::json_pointer place(pointer);
    return summary.is_object() && summary.contains(place) ? summary[place] : json();
  };
  const json recording = at("/input/path");
  return RunSummary{.recording = recording.is_string() ? recording.get<std::string>() : "",
                    .maps = at("/configuration/mapping/enabled") != json(false)};
}

[[noreturn]] void refuse_missing(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const bool of_a_run = file.filename() == RunFiles(folder).database.filename();
  const std::optional<RunSummary> run = of_a_run ? summary_in(folder) : std::nullopt;
  const std::string missing = "there is no such file";
  if (!run) {
    throw InputError(file, {}, missing, kHowToMake);
  }
  if (run->maps) {
    throw InputError(file, {}, missing + ", although the run in its folder makes one",
                     "Copy the map back if it was moved, or run again");
  }
  const std::string recording = run->recording.empty() ? "RECORDING" : run->recording;
  throw InputError(file, {},
                   missing +
                       ": the run in its folder computed the odometry alone (--odometry or "
                       "mapping.enabled=false)",
                   "Run again without that: adit run " + recording + " -o OUT");
}

}  // namespace

fs::path map_file(const fs::path& what) {
  std::error_code unknown;
  return fs::is_directory(what, unknown) ? RunFiles(what).database : what;
}

fs::path find_map(const fs::path& what) {
  fs::path file = map_file(what);
  std::error_code error;
  if (fs::status(file, error).type() == fs::file_type::not_found) {
    refuse_missing(file);
  }
  return file;
}

}  // namespace adit
