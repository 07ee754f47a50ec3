// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "adit/tools/live/live_options.hpp"

namespace adit {

/// The file in OUT that what arrives goes to, of that name. One that is there is removed where
/// --overwrite is given. Throws UsageError where results or a recording are there otherwise.
std::filesystem::path prepare_recording(const RunCommandOptions& run, const std::string& name);

/// A recording that goes away, and its folder if that is empty then, unless it is kept: where
/// nothing arrives the same command may be given again.
class PendingRecording {
 public:
  explicit PendingRecording(std::filesystem::path file) : file_(std::move(file)) {}
  ~PendingRecording();
  PendingRecording(const PendingRecording&) = delete;
  PendingRecording& operator=(const PendingRecording&) = delete;

  void keep() { kept_ = true; }

 private:
  std::filesystem::path file_;
  bool kept_ = false;
};

/// Removes what was recorded, unless it is to stay.
void end_recording(const LiveOptions& options, const std::filesystem::path& file);

}  // namespace adit
