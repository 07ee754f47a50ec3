// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit run --view`: the page of a run while it goes on, and of its result.
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

#include "adit/tools/report/run_statistics.hpp"
#include "adit/tools/report/run_summary.hpp"
#include "adit/tools/run/served_page.hpp"
#include "adit/tools/viewer/live_view.hpp"

namespace adit {

class RunView {
 public:
  /// Serves from now on. Throws UsageError where the port cannot be listened on, and
  /// std::runtime_error where this build has no page.
  RunView(const ServeOptions& options, const std::filesystem::path& recording, std::ostream& err);

  /// Prints the link: the run is about to begin.
  void say_link() const;
  /// What the run is doing, in words.
  void set_doing(const std::string& doing) { live_.set_doing(doing); }
  /// The map that the run writes.
  void show_map(const std::filesystem::path& map) { live_.show_map(map); }
  /// The next sweep; `sweeps` are to be mapped in all.
  void add(const SweepPlaced& placed, const RunStatistics& statistics, std::size_t sweeps);
  /// There are no more sweeps, and the map is read no more.
  void end_mapping(const RunOutcome& outcome, const RunStatistics& statistics, Trust trust);
  /// Shows what the folder holds until a signal comes; nothing where one has come already.
  void serve_result(const std::filesystem::path& folder, bool quiet);

 private:
  std::ostream& err_;
  ViewAccess access_;
  bool foxglove_;  ///< its link is printed
  LiveView live_;
  std::optional<Nanoseconds> first_{};  ///< stamp of the first sweep
  std::string end_;                     ///< how the run has ended, in words
};

}  // namespace adit
