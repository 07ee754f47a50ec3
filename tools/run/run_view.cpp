// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_view.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <memory>
#include <ostream>
#include <span>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/report/source_table.hpp"
#include "adit/tools/report/verdict_text.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostStretches = 32;  // that pages are told of while a run goes on

bool is_stopped() {
  return StopSignal::received() != 0;
}

/// What the run has left to be shown; nothing where it left no points, or a signal has come.
std::unique_ptr<ViewData> result_in(const std::filesystem::path& folder, std::ostream& progress,
                                    std::ostream& err) {
  try {
    return std::make_unique<ViewData>(ViewDataOptions{.what = folder, .stop = is_stopped},
                                      progress);
  } catch (const ViewStopped&) {
    return nullptr;
  } catch (const FileError& error) {
    err << "note: the page stays as it was at the end of the run: " << error.what() << "\n";
    return nullptr;
  }
}

std::vector<LiveStretch> last_stretches(const Verdict& verdict, Nanoseconds first) {
  const std::size_t told = std::min(kMostStretches, verdict.stretches.size());
  std::vector<LiveStretch> last;
  for (const DoubtfulStretch& one : std::span(verdict.stretches).last(told)) {
    last.push_back({.state = std::string(to_string(one.trust)),
                    .begin = one.begin,
                    .end = one.end,
                    .text = describe(one, first)});
  }
  return last;
}

}  // namespace

RunView::RunView(const ServeOptions& options, const std::filesystem::path& recording,
                 std::ostream& err)
    : err_(err),
      access_(access_of(options)),
      foxglove_(options.foxglove),
      live_(recording.filename().string(), required_page(), access_,
            static_cast<uint16_t>(options.port)) {}

void RunView::say_link() const {
  adit::say_link(live_.link(), access_, "sees the run and its map", err_);
  if (foxglove_) {
    say_foxglove_link(live_.foxglove_link(), err_);
  }
}

void RunView::add(const SweepPlaced& placed, const RunStatistics& statistics, std::size_t sweeps) {
  if (!first_) {
    first_ = placed.result.stamp;
  }
  const Verdict verdict = statistics.verdict();
  live_.add(placed, {.sweeps = statistics.sweeps(),
                     .of = sweeps,
                     .failed = statistics.failures().size(),
                     .verdict = std::string(to_string(verdict.trust)),
                     .stretches = last_stretches(verdict, *first_),
                     .sources = motion_sources(statistics)});
}

void RunView::end_mapping(const RunOutcome& outcome, const RunStatistics& statistics, Trust trust) {
  live_.leave_map();
  end_ =
      outcome.result.end == RunEnd::completed
          ? fmt::format("The run has ended: {} sweeps, {}.", statistics.sweeps(), to_string(trust))
          : fmt::format("The run has ended early, after {} sweeps: {}", statistics.sweeps(),
                        outcome.result.reason);
  live_.set_doing("ended");
}

void RunView::serve_result(const std::filesystem::path& folder, bool quiet) {
  std::ostream nowhere(nullptr);
  bool shown = false;
  if (!is_stopped()) {
    std::unique_ptr<ViewData> result = result_in(folder, quiet ? nowhere : err_, err_);
    shown = result != nullptr;
    if (shown) {
      live_.show_result(std::move(result), end_);
    }
  }
  if (!is_stopped() && live_.serves()) {
    err_ << (shown ? "The run has ended; its result is shown at "
                   : "The run has ended; the page stays at ")
         << live_.link() << "\nCtrl-C ends it." << std::endl;
  }
  try {
    const ViewCounts counts = live_.end(is_stopped);
    if (!quiet) {
      say_counts(counts, err_);
    }
  } catch (const std::exception& error) {
    err_ << "adit run: warning: the page was not served to the end: " << error.what() << std::endl;
  }
}

}  // namespace adit
