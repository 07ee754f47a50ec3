// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_changes.hpp"

#include <iostream>
#include <memory>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/map_changes/changes_report.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

constexpr int kStoppedBySignal = 128;

int compare(const ChangesCommandOptions& options, std::ostream& out, std::ostream& err) {
  const StopSignal stop;
  Progress progress(err, options.quiet ? ProgressStyle::none : progress_style_of_stderr(),
                    "compare", kUnknownTotal, Progress::Clock::now(), "steps");
  try {
    const ChangesOutcome outcome = changes_job(options, [&](const ChangesStep& step) {
      progress.update(step.done, 0);
      return StopSignal::received() == 0;
    });
    progress.finish();
    out << (options.json ? to_json(options, outcome) : describe_changes(options, outcome));
    return 0;
  } catch (const MergeStopped&) {
    progress.finish();
    err << "adit changes: stopped; nothing was written" << std::endl;
    return kStoppedBySignal + StopSignal::received();
  }
}

}  // namespace

int changes_command(const ChangesCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit changes", out, err, [&] { return compare(options, out, err); });
}

void add_changes_command(Command app, std::function<void(int)> done) {
  const Command command =
      app.add_command("changes", "List what has changed between the sessions of a map");
  const auto options = std::make_shared<ChangesCommandOptions>();
  command.footer(
      "MAP is a map of several sessions, as `adit merge` and `adit run --extend` make them: they "
      "are compared in the order of time. Of two maps the first is BEFORE and the second AFTER; "
      "they are tied to each other first, as `adit merge` does, and stay as they are.\n\n"
      "A surface is gone where at least two submaps of later sessions see through it, and new "
      "where earlier ones saw through its place. What the other sessions did not see is unknown "
      "and not listed, and neither is what moves during a session.\n\n"
      "Examples:\n"
      "  adit changes site.adit\n"
      "  adit changes monday tuesday -o changes.geojson\n\n"
      "Exit codes: 0 compared, 1 failed, 2 usage, 129, 130 or 143 stopped (nothing is written).");
  command.option("maps", options->maps, "A map of several sessions, or two maps; or their folders")
      .required()
      .value_name("MAP|OUT");
  command
      .option("-o,--output", options->output,
              "GeoJSON with a polygon for each change: WGS 84 where the map is georeferenced")
      .value_name("FILE.geojson")
      .written({".geojson", ".json"});
  add_device_options(command, options->device);
  command.flag("--quiet", options->quiet, "Print errors and the report alone");
  command.flag("--json", options->json, "Report as JSON");
  command.action(
      [options, done = std::move(done)] { done(changes_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
