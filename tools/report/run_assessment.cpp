// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/run_assessment.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/core.h>

#include "adit/slam/odometry/motion_model.hpp"
#include "adit/tools/report/localization_text.hpp"
#include "adit/tools/report/verdict_text.hpp"

namespace adit {
namespace {

// Sweeps that are missing one by one are bridged, and the trajectory is the same; up to this share
// of them, ten in a row are missing by chance in less than one of 10^9 places.
constexpr double kMostMissing = 0.1;
// An IMU that is used at all has started by then (docs/theory/inertial.md, section 5).
constexpr double kLongestStart = 10.0;  // s

using MaybeReason = std::optional<VerdictReason>;

Coverage coverage_of(const RunDescription& run, const RunStatistics& statistics) {
  const std::size_t placed = statistics.sweeps();
  const std::size_t known = placed + statistics.left_out().sweeps();
  Coverage coverage{.sweeps = std::max(run.range.count, known), .placed = placed};
  const std::size_t steps = statistics.last_index() - statistics.first_index();
  if (placed == 0 || steps == 0) {
    coverage.longest = coverage.missing();
    return coverage;
  }
  const std::size_t at_first = statistics.first_index() - run.range.first;
  const std::size_t end = run.range.first + coverage.sweeps;
  const std::size_t at_last = end - std::min(end, statistics.last_index() + 1);
  coverage.longest =
      std::min(coverage.missing(), std::max({at_first, at_last, statistics.longest_missing()}));
  coverage.longest_seconds = statistics.recorded_seconds() / static_cast<double>(steps) *
                             static_cast<double>(coverage.longest);
  return coverage;
}

MaybeReason judge_coverage(const Coverage& coverage) {
  const bool many =
      static_cast<double>(coverage.missing()) > kMostMissing * static_cast<double>(coverage.sweeps);
  if (!many && coverage.longest_seconds <= kLongestExtrapolation) {
    return std::nullopt;
  }
  const std::string in_a_row = coverage.longest_seconds > 0.0
                                   ? fmt::format(", {} of them in a row ({:.1f} s)",
                                                 coverage.longest, coverage.longest_seconds)
                                   : std::string();
  return VerdictReason{
      .cause = "missing sweeps",
      .text = fmt::format("{} of {} sweeps are not in the trajectory{}; `adit inspect` of the "
                          "recording lists its faults",
                          coverage.missing(), coverage.sweeps, in_a_row)};
}

// Without a file, or an end, nobody knows how many sweeps are missing.
MaybeReason judge_files(const LeftOut& left_out, const Coverage& coverage) {
  if (left_out.lacks_files()) {
    return VerdictReason{
        .cause = "missing files",
        .text =
            "the recording declares a file that is not there; how many sweeps were in it is "
            "not known"};
  }
  if (left_out.ends_damaged() && coverage.missing() == 0) {
    return VerdictReason{
        .cause = "cut off",
        .text =
            "the recording ends with a damaged place, as if it was cut off; how much of it is "
            "missing is not known: copy it again, if there is more"};
  }
  return std::nullopt;
}

MaybeReason judge_clock(const LeftOut& left_out) {
  if (left_out.clock_steps().empty()) {
    return std::nullopt;
  }
  return VerdictReason{.cause = "clock", .text = left_out.clock_text()};
}

MaybeReason judge_end(const RunOutcome& outcome) {
  if (outcome.result.end == RunEnd::completed) {
    return std::nullopt;
  }
  return VerdictReason{.cause = "ended early",
                       .text = "the run ended early: " + outcome.result.reason};
}

/// Whether sweeps were compared with each other at all.
MaybeReason judge_comparisons(const RunStatistics& statistics, const Verdict& verdict) {
  if (verdict.trust == Trust::lost && verdict.stretches.empty()) {
    return VerdictReason{.cause = "not aligned",
                         .trust = Trust::lost,
                         .text = "no sweep could be aligned with the ones before it"};
  }
  if (statistics.sweeps() == 1) {
    return VerdictReason{.cause = "not checked",
                         .text =
                             "one sweep alone cannot be compared with another: nothing was "
                             "checked"};
  }
  return std::nullopt;
}

MaybeReason judge_imu(const RunStatistics& statistics) {
  const InertialStatistics& imu = statistics.inertial();
  if (!imu.any()) {
    return std::nullopt;
  }
  const std::size_t fused = imu.count(InertialState::fused);
  const std::size_t without = imu.count(InertialState::refused) + imu.count(InertialState::lost);
  const bool never = fused == 0 && statistics.recorded_seconds() > kLongestStart;
  // None of its readings could be used, or no more of them are.
  const bool left =
      imu.last_state() == InertialState::absent || imu.last_state() == InertialState::refused;
  if (!never && !left && without <= fused) {
    return std::nullopt;
  }
  const std::string why = imu.why_not_fused();
  return VerdictReason{
      .cause = "imu rejected",
      .text =
          fmt::format("the IMU was fused in {} of {} sweeps, the others rely on the range sensor "
                      "alone{}; imu.use=false maps without it",
                      fused, statistics.sweeps(), why.empty() ? "" : " (" + why + ")")};
}

MaybeReason judge_parts(const RunOutcome& outcome) {
  if (!outcome.result.map || outcome.result.map->components <= 1) {
    return std::nullopt;
  }
  return VerdictReason{
      .cause = "parts",
      .text = fmt::format("the map has {} parts that nothing ties together: how they lie to each "
                          "other is a guess; a loop, GNSS or `adit loops` can tie them",
                          outcome.result.map->components)};
}

// A map of which no place was recognised places nothing.
MaybeReason judge_localization(const RunOutcome& outcome) {
  if (!outcome.result.map || !outcome.result.map->localization.any()) {
    return std::nullopt;
  }
  const Localization& found = outcome.result.map->localization;
  if (found.recognised > 0 && found.state != LocalizationState::lost &&
      found.state != LocalizationState::unconfirmed) {
    return std::nullopt;
  }
  return VerdictReason{.cause = "not localized",
                       .text = "in the earlier map: " + std::string(to_string(found.state)) + "; " +
                               describe(found)};
}

MaybeReason judge_loops(const Verdict& verdict) {
  if (!verdict.moved) {
    return std::nullopt;
  }
  return VerdictReason{.cause = "loops", .text = describe(*verdict.moved)};
}

}  // namespace

RunAssessment assess_run(const RunDescription& run, const RunOutcome& outcome,
                         const RunStatistics& statistics) {
  Verdict verdict = statistics.verdict();
  RunAssessment assessment{.coverage = coverage_of(run, statistics)};
  for (MaybeReason& reason :
       std::array{judge_end(outcome), judge_clock(statistics.left_out()),
                  judge_coverage(assessment.coverage), judge_comparisons(statistics, verdict),
                  judge_files(statistics.left_out(), assessment.coverage), judge_imu(statistics),
                  judge_parts(outcome), judge_localization(outcome), judge_loops(verdict)}) {
    if (reason) {
      assessment.trust = std::max(assessment.trust, reason->trust);
      assessment.reasons.push_back(std::move(*reason));
    }
  }
  const bool tied = outcome.result.map && outcome.result.map->components == 1;
  for (DoubtfulStretch& stretch : verdict.stretches) {
    stretch.tied = tied && stretch.cause == DoubtCause::new_start;
    stretch.trust = stretch.tied ? Trust::doubtful : stretch.trust;
    assessment.trust = std::max(assessment.trust, stretch.trust);
  }
  assessment.stretches = std::move(verdict.stretches);
  assessment.moved = verdict.moved;
  return assessment;
}

}  // namespace adit
