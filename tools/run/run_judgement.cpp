// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_judgement.hpp"

#include <ostream>
#include <string>

#include <nlohmann/json.hpp>

#include "adit/tools/report/gnss_text.hpp"
#include "adit/tools/report/measurement_faults_text.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/stop_signal.hpp"

namespace adit {
namespace {

/// Of a run that ended early.
std::string what_is_kept(const RunOutcome& outcome, const RunDescription& run) {
  if (!run.kept) {
    return "nothing is kept (adit run -o OUT keeps it)";
  }
  const bool goes_on = run.config.mapping.enabled && outcome.result.end != RunEnd::input_error;
  return "what was computed is kept" +
         (goes_on ? "; adit run -o " + run.output.string() + " --continue goes on from there"
                  : std::string());
}

}  // namespace

int judge_run(const RunOutcome& outcome, const RunStatistics& statistics, const RunDescription& run,
              std::ostream& err) {
  for (const std::string& message : outcome.validation_messages) {
    err << "adit run: validation: " << message << "\n";
  }
  if (outcome.result.end != RunEnd::completed) {
    err << "adit run: " << outcome.result.reason << "\n"
        << "adit run: ended early, " << statistics.sweeps() << " of " << run.range.count
        << " sweeps done; " << what_is_kept(outcome, run) << std::endl;
    return outcome.result.end == RunEnd::interrupted ? 128 + StopSignal::received() : 1;
  }
  for (const std::string& fault : describe(outcome.result.faults)) {
    err << "adit run: warning: " << fault << std::endl;
  }
  if (outcome.result.map && outcome.result.map->gnss.jump) {
    err << "adit run: warning: " << describe(*outcome.result.map->gnss.jump) << std::endl;
  }
  if (outcome.result.map && is_refused(outcome.result.map->gnss.heading)) {
    err << "adit run: warning: " << describe(outcome.result.map->gnss.heading) << std::endl;
  }
  if (statistics.left_out().any()) {
    err << "adit run: warning: left out: " << statistics.left_out().text() << std::endl;
  }
  if (statistics.left_out().put_in_order() > 0) {
    err << "adit run: warning: " << statistics.left_out().order_text() << std::endl;
  }
  const InertialStatistics& imu = statistics.inertial();
  const std::size_t repeated = imu.count(ImuArrival::duplicate);
  const std::size_t back = imu.count(ImuArrival::too_late) + imu.count(ImuArrival::restarted);
  if (repeated + back > 0) {
    err << "adit run: warning: the IMU's clock: " << repeated << " readings repeat a time, " << back
        << " go back" << std::endl;
  }
  if (statistics.sweeps() == 0 && statistics.left_out().damaged() > 0) {
    err << "adit run: not one sweep could be read; " << statistics.left_out().first_damage()
        << std::endl;
    return 1;
  }
  if (statistics.sweeps() > 1 && statistics.count(OdometryState::tracking) == 0) {
    err << "adit run: not one sweep could be aligned with the ones before it; the trajectory is a "
           "guess"
        << std::endl;
    return 1;
  }
  return outcome.validation_messages.empty() ? 0 : 1;
}

int judge_strictly(int code, Trust trust, const RunStatistics& statistics, std::ostream& err) {
  if (code != 0) {
    return code;
  }
  if (trust != Trust::reliable) {
    err << "adit run: the run is " << to_string(trust)
        << " (--strict); verdict in summary.json says where and why" << std::endl;
    return 1;
  }
  if (statistics.left_out().lacks_sweeps()) {
    err << "adit run: the recording lacks sweeps that it declares (--strict); left_out in "
           "summary.json lists what is missing"
        << std::endl;
    return 1;
  }
  return 0;
}

std::string notes_of(const Recording& recording) {
  std::string notes;
  for (const RecordingNotice& notice : recording.notices()) {
    notes += "note: " + notice.found + "; " + notice.effect + "\n";
  }
  return notes;
}

int tell_of_complete_run(const EarlierRun& run, const RunCommandOptions& options, std::ostream& out,
                         std::ostream& err) {
  if (!options.quiet) {
    err << "adit run: " << run.map.string()
        << " is complete, its recording was mapped to the end; there is nothing to go on with"
        << std::endl;
  }
  const std::string summary = read_text_file(RunFiles(options.output).summary);
  if (options.json) {
    out << summary << std::flush;
  }
  const auto json = nlohmann::json::parse(summary, nullptr, false);
  const std::string state =
      json.is_object() ? json.value(nlohmann::json::json_pointer("/verdict/state"), "") : "";
  return options.strict && state != to_string(Trust::reliable) ? 1 : 0;
}

}  // namespace adit
