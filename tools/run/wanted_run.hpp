// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/run/run_options.hpp"

namespace adit {

/// What `adit run` is to do, once its options are put together with what a map tells of the run
/// that made it.
struct WantedRun {
  RunCommandOptions options;
  std::optional<EarlierRun> continued;  ///< whose map is gone on with
};

/// Where a run of the recording goes whose folder is not named: ./NAME, by the name of the file
/// without its extension or of the folder; ./NAME-out where NAME is the recording or a file.
std::filesystem::path default_output(const std::filesystem::path& recording);

/// Throws UsageError where options do not fit together or a recording is missing, and InputError
/// for a map that cannot be gone on with.
WantedRun wanted_run(const RunCommandOptions& options);

/// As check_output_folder() of each of the recordings: whether an earlier run's results are there.
bool check_output_folder(const RunCommandOptions& options);

}  // namespace adit
