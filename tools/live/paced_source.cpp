// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/paced_source.hpp"

#include <memory>
#include <ostream>

#include "adit/tools/live/live_outputs.hpp"
#include "adit/tools/run/run_job.hpp"
#include "adit/tools/run/wanted_run.hpp"
#include "adit/tools/setup/configured_recording.hpp"

namespace adit {

int map_paced(const LiveOptions& options, RunView* view, std::ostream& out, std::ostream& err) {
  RunCommandOptions given = options.run;
  given.recording = options.sources.front();
  const WantedRun chosen = wanted_run(given);
  LiveOutputs outputs(
      options, nullptr, [] { return std::vector<SourceCounts>(); }, err);
  const OpenSource open = [&](const Config& config) {
    RunSource source{.known = open_recording(chosen.options.recording, config.recording),
                     .ends_by_itself = true};
    outputs.attach(source, options.speed);
    return source;
  };
  const int code = run_job(chosen, open, view, out, err);
  if (!given.quiet) {
    say_latency(outputs.report(), err);
  }
  return code;
}

}  // namespace adit
