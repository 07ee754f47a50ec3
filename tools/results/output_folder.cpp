// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/output_folder.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

#include <nlohmann/json.hpp>

#include "adit/tools/results/high_rate_output.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/results/run_outputs.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/usage_error.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// What `evaluate` and `demo` add to a run's folder by themselves.
constexpr std::array kDrawings = {"evaluation.html", "evaluation.svg", "map.svg"};

void remove_file(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) {
    throw OutputError(file, file.string() + ": the earlier run's file cannot be removed: " +
                                error.message() + ". Choose another folder with -o.");
  }
}

}  // namespace

std::vector<fs::path> result_files(const fs::path& folder) {
  const RunFiles files(folder);
  const HighRateFiles high_rate(folder);
  // A map that was written to until its process was killed has a log beside it.
  return {files.summary,
          files.tum,
          files.kitti,
          files.sweeps,
          files.map,
          files.page,
          files.odometry,
          files.online,
          files.localization,
          files.database,
          files.database.string() + "-wal",
          files.database.string() + "-shm",
          high_rate.tum,
          high_rate.csv};
}

bool drawn_by_us(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string head(512, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.find("name=\"generator\" content=\"" + std::string(kGenerator)) != head.npos ||
         head.find("data-generator=\"" + std::string(kGenerator)) != head.npos;
}

bool holds_a_run(const fs::path& folder) {
  const fs::path summary = RunFiles(folder).summary;
  std::error_code unknown;
  if (!fs::is_regular_file(summary, unknown)) {
    return false;
  }
  const auto json = nlohmann::json::parse(read_text_file(summary), nullptr, false);
  return json.is_object() && json.contains("adit") && json.contains("status");
}

bool is_run(const fs::path& folder) {
  std::error_code unknown;
  return holds_a_run(folder) || fs::is_regular_file(RunFiles(folder).sweeps, unknown);
}

bool check_output_folder(const fs::path& recording, const fs::path& folder) {
  if (is_within(folder, recording)) {
    throw UsageError("-o " + folder.string() +
                     ": the results would be written into the recording " + recording.string() +
                     ". Name a folder outside of it.");
  }
  const std::vector<fs::path> files = result_files(folder);
  const auto input =
      std::ranges::find_if(files, [&](const fs::path& file) { return same_file(file, recording); });
  if (input != files.end()) {
    throw UsageError("-o " + folder.string() + ": the results would replace the recording " +
                     input->string() + ". Name another folder.");
  }
  if (holds_a_run(folder)) {
    return true;
  }
  // Devices and pipes hold nothing that could be lost.
  const auto foreign = std::ranges::find_if(files, [](const fs::path& file) {
    std::error_code unknown;
    return fs::is_regular_file(file, unknown);
  });
  if (foreign != files.end()) {
    throw UsageError("-o " + folder.string() + ": " + foreign->filename().string() +
                     " is there and no summary.json of a run beside it, so that it may not be "
                     "adit's. Name another folder, or move the file away.");
  }
  return false;
}

void require_no_results(const fs::path& folder) {
  std::string found;
  for (const fs::path& file : result_files(folder)) {
    std::error_code unknown;
    if (file != RunFiles(folder).summary && fs::is_regular_file(file, unknown) &&
        fs::file_size(file, unknown) > 0) {
      found += (found.empty() ? "" : ", ") + file.filename().string();
    }
  }
  if (!found.empty()) {
    throw UsageError("-o " + folder.string() + ": the folder holds an earlier run (" + found +
                     "). Name another folder, or replace the run with --overwrite; --continue "
                     "goes on with a run that was stopped.");
  }
}

void remove_earlier_run(const fs::path& folder, EarlierMap map) {
  const std::string database = RunFiles(folder).database.string();
  for (const fs::path& file : result_files(folder)) {
    std::error_code unknown;
    const bool kept = file == RunFiles(folder).summary ||
                      (map == EarlierMap::keep && file.string().starts_with(database));
    if (!kept && !fs::is_directory(file, unknown)) {
      remove_file(file);
    }
  }
  for (const char* name : kDrawings) {
    if (drawn_by_us(folder / name)) {
      remove_file(folder / name);
    }
  }
}

}  // namespace adit
