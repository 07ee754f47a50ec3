// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <utility>

#include "adit/tools/live/live_options.hpp"
#include "adit/tools/report/run_summary.hpp"

namespace adit {

/// The file in OUT that what arrives goes to, of that name. One that is there is removed where
/// --overwrite is given. Throws UsageError where results or a recording are there otherwise.
std::filesystem::path prepare_recording(const RunCommandOptions& run, const std::string& name);

/// The folder of a session, counted from 1: OUT, OUT-2, OUT-3 and so on; with --overwrite of that
/// number, else of the next one that is not there.
std::filesystem::path session_folder(const RunCommandOptions& run, std::size_t number);

/// A recording that is removed unless it is kept, and `folder`, if one is named, where that is
/// empty then: where nothing arrives the same command may be given again.
class PendingRecording {
 public:
  explicit PendingRecording(std::filesystem::path file, std::filesystem::path folder = {})
      : file_(std::move(file)), folder_(std::move(folder)) {}
  ~PendingRecording();
  PendingRecording(const PendingRecording&) = delete;
  PendingRecording& operator=(const PendingRecording&) = delete;

  void keep() { kept_ = true; }

 private:
  std::filesystem::path file_;
  std::filesystem::path folder_;
  bool kept_ = false;
};

/// Prints why no next session begins.
void say_no_session(const std::string& reason, std::ostream& err);

/// Ends a live run whose job gave `code`: prints the latency, removes the recording unless it is to
/// stay, and prints why receiving ended early, if it did (`failure`). Returns the exit code.
int end_live(const LiveOptions& options, const std::filesystem::path& recording,
             const LiveReport& report, const std::string& failure, int code, std::ostream& err);

}  // namespace adit
