// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The job that `adit run` and `adit live` share: from a source of sweeps to the results in a
// folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>

#include "adit/slam/core/config.hpp"
#include "adit/slam/executor/slam.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/report/run_summary.hpp"
#include "adit/tools/run/run_view.hpp"
#include "adit/tools/run/wanted_run.hpp"

namespace adit {

/// A run whose first sweep is next.
struct BegunRun {
  const Recording& mapped;           ///< what is mapped; outlives the run
  std::optional<std::size_t> imu{};  ///< the topic of the inertial readings that are used
  const Config& config;
  std::optional<std::filesystem::path> map{};  ///< the database that it writes
};

/// Where the sweeps of a run come from, and who follows it.
struct RunSource {
  std::unique_ptr<Recording> known;         ///< what can be examined before the first sweep
  std::unique_ptr<Recording> arriving{};    ///< is mapped; null: `known` is
  std::unique_ptr<Recording> underlying{};  ///< what `arriving` reads, where that is another
  bool endless = false;         ///< the number of sweeps is unknown until the source ends
  bool ends_by_itself = false;  ///< a signal ends the source, and the run is complete then
  std::function<void(const BegunRun&)> begun{};  ///< called before the first sweep
  std::function<void(const Sweep&, const SweepResult&)> placed{};  ///< SlamOptions::placed
  std::function<void(const SweepPlaced&)> mapped{};  ///< gets each sweep when it is written
  /// Called after the last sweep: the map must not be read any more.
  std::function<void(const MappingResult&)> ended{};
  std::function<LiveReport()> report{};  ///< called once after the last sweep; empty: not live
};

/// Opens the source with the effective configuration. Throws InputError.
using OpenSource = std::function<RunSource(const Config&)>;

/// Maps what the source gives into the folder of `chosen`, and prints the result. Returns the exit
/// code of run_command(). `view` may be null; it changes nothing of the results.
int run_job(const WantedRun& chosen, const OpenSource& open, RunView* view, std::ostream& out,
            std::ostream& err);

}  // namespace adit
