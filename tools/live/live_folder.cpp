// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/live_folder.hpp"

#include <system_error>

#include "adit/tools/results/output_folder.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {

namespace fs = std::filesystem;

fs::path prepare_recording(const RunCommandOptions& run, const std::string& name) {
  fs::path file = run.output / name;
  check_output_folder(file, run.output);
  if (!run.overwrite) {
    require_no_results(run.output);
  }
  std::error_code error;
  if (fs::exists(file, error) && !run.overwrite) {
    throw UsageError(file.string() +
                     ": there is a recording already. Name another folder with -o, "
                     "or replace it with --overwrite.");
  }
  fs::create_directories(run.output, error);
  fs::remove(file, error);
  return file;
}

PendingRecording::~PendingRecording() {
  if (!kept_) {
    std::error_code ignored;
    fs::remove(file_, ignored);
    fs::remove(file_.parent_path(), ignored);  // fails where other files are in it
  }
}

void end_recording(const LiveOptions& options, const fs::path& file) {
  if (!options.record) {
    std::error_code ignored;
    fs::remove(file, ignored);
  }
}

}  // namespace adit
