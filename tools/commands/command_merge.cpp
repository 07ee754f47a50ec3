// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_merge.hpp"

#include <iostream>
#include <memory>
#include <string>

#include <fmt/core.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/map_merge/merge_report.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

constexpr int kExitBySignal = 128;

int run(const MergeCommandOptions& options, std::ostream& out, std::ostream& err) {
  const StopSignal stop;
  Progress progress(err, options.quiet ? ProgressStyle::none : progress_style_of_stderr(), "merge",
                    kUnknownTotal, Progress::Clock::now(), "keyframes");
  std::size_t done = 0;
  try {
    const MergeOutcome outcome = merge_job(options, [&](const MergeStep&) {
      progress.update(++done, 0);
      return StopSignal::received() == 0;
    });
    progress.finish();
    out << (options.json ? to_json(options, outcome) : describe(options, outcome));
    return outcome.sessions.empty() ? 1 : 0;
  } catch (const MergeStopped&) {
    progress.finish();
    err << "adit merge: stopped; nothing was written" << std::endl;
    return kExitBySignal + StopSignal::received();
  }
}

}  // namespace

int merge_command(const MergeCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit merge", out, err, [&] { return run(options, out, err); });
}

void add_merge_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command("merge", "Merge maps that have places in common");
  const auto options = std::make_shared<MergeCommandOptions>();
  command.footer(
      "OUT is the folder of a run, MAP the map in it, OUT/map.adit.\n"
      "Each map is searched for in the others where both have it in the world by GNSS or control "
      "points, and else by what its keyframes look like. It is merged only "
      "if several keyframes agree on its place and no other place is nearly as likely; maps that "
      "stay apart are reported, and are not in the merged map. The order of the maps makes no "
      "difference. The maps themselves stay as they are.\n\n"
      "Examples:\n"
      "  adit merge monday tuesday -o site.adit\n"
      "  adit merge floor1/map.adit floor2/map.adit stairs -o building.adit --json\n\n"
      "Exit codes: 0 merged, 1 failed or no map could be tied to another, 2 usage, 129, 130 or 143 "
      "stopped (nothing is written).");
  command.option("maps", options->maps, "Two maps or more, or the folders of their runs")
      .required()
      .value_name("MAP|OUT");
  command.option("-o,--output", options->output, "The map to write; must not be there yet")
      .required()
      .value_name("MERGED.adit")
      .written();
  command.flag("--same-site", options->settings.same_site,
               "You know that the maps are of one site: another place that looks like it, which "
               "none of them has, is not considered");
  add_device_options(command, options->device);
  command.flag("--quiet", options->quiet, "Print errors and the report alone");
  command.flag("--json", options->json, "Report as JSON");
  command.action(
      [options, done = std::move(done)] { done(merge_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
