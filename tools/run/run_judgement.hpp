// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit run` says at its end, and its exit code.
#pragma once

#include <iosfwd>
#include <string>

#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/report/run_statistics.hpp"
#include "adit/tools/report/run_summary.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/run/run_options.hpp"

namespace adit {

/// Says what went wrong with a run and returns the exit code.
int judge_run(const RunOutcome& outcome, const RunStatistics& statistics, const RunDescription& run,
              std::ostream& err);

/// With --strict: the exit code of a run with that verdict. Where `code` is 0: 1 if the run is not
/// reliable, or if the recording lacks sweeps that it declares, and says so.
int judge_strictly(int code, Trust trust, const RunStatistics& statistics, std::ostream& err);

/// What opening a recording found worth knowing, a line each.
std::string notes_of(const Recording& recording);

/// What is known of a run that has nothing left to do: as if it had ended now. Returns the exit
/// code.
int tell_of_complete_run(const EarlierRun& run, const RunCommandOptions& options, std::ostream& out,
                         std::ostream& err);

}  // namespace adit
