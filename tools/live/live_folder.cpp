// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/live_folder.hpp"

#include <ostream>
#include <system_error>

#include "adit/tools/live/live_latency.hpp"
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

fs::path session_folder(const RunCommandOptions& run, std::size_t number) {
  if (number == 1) {
    return run.output;
  }
  std::error_code unknown;
  fs::path folder;
  do {
    folder = run.output;
    folder += "-" + std::to_string(number++);
  } while (!run.overwrite && fs::exists(folder, unknown));
  return folder;
}

PendingRecording::~PendingRecording() {
  if (!kept_) {
    std::error_code ignored;
    fs::remove(file_, ignored);
    fs::remove(folder_, ignored);  // fails where other files are in it
  }
}

void say_no_session(const std::string& reason, std::ostream& err) {
  err << ("note: no session begins, and this one goes on: " + reason + "\n") << std::flush;
}

int end_live(const LiveOptions& options, const fs::path& recording, const LiveReport& report,
             const std::string& failure, int code, std::ostream& err) {
  if (!options.run.quiet) {
    say_latency(report, err);
  }
  if (!options.record) {
    std::error_code ignored;
    fs::remove(recording, ignored);
  }
  if (!failure.empty()) {
    err << "adit live: receiving ended early: " << failure << "\n";
    return 1;
  }
  return code;
}

}  // namespace adit
