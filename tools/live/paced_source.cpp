// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/paced_source.hpp"

#include <memory>
#include <ostream>

#include "adit/tools/live/live_latency.hpp"
#include "adit/tools/live/live_recording.hpp"
#include "adit/tools/run/run_job.hpp"
#include "adit/tools/run/wanted_run.hpp"
#include "adit/tools/setup/configured_recording.hpp"

namespace adit {

int map_paced(const LiveOptions& options, RunView* view, std::ostream& out, std::ostream& err) {
  RunCommandOptions given = options.run;
  given.recording = options.sources.front();
  const WantedRun chosen = wanted_run(given);
  ArrivalTimes arrivals;
  LiveLatency latency(arrivals);
  const OpenSource open = [&](const Config& config) {
    RunSource source{.known = open_recording(chosen.options.recording, config.recording)};
    source.arriving = std::make_unique<LiveRecording>(*source.known, options.speed, arrivals);
    source.ends_by_itself = true;
    source.placed = [&](const Sweep& sweep, const SweepResult&) { latency.add(sweep.stamp); };
    source.report = [&] { return latency.report(); };
    return source;
  };
  const int code = run_job(chosen, open, view, out, err);
  if (!given.quiet) {
    say_latency(latency.report(), err);
  }
  return code;
}

}  // namespace adit
