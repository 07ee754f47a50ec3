// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit run` says at its end.
#include "adit/tools/run/run_judgement.hpp"

#include <algorithm>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace adit {
namespace {

/// Of a run that a signal ended.
std::string said_of(const RunDescription& run) {
  RunOutcome outcome;
  outcome.result.end = RunEnd::interrupted;
  outcome.result.reason = "stopped by a signal";
  const RunStatistics statistics{run.config};
  std::ostringstream said;
  EXPECT_GE(judge_run(outcome, statistics, run, said), 128);
  return said.str() + summary_table(run, outcome, statistics, RunDetail::whole);
}

TEST(RunJudgement, OfAFolderThatGoesAwayNothingIsSaidToBeKept) {
  RunDescription run;
  run.output = "out";
  const std::string kept = said_of(run);
  for (const char* part : {"adit run -o out --continue goes on", "wrote    out/trajectory.tum"}) {
    EXPECT_NE(kept.find(part), std::string::npos) << kept;
  }
  run.kept = false;
  const std::string gone = said_of(run);
  EXPECT_NE(gone.find("nothing is kept (adit run -o OUT keeps it)"), std::string::npos) << gone;
  for (const char* part : {"--continue", "wrote", "what was computed"}) {
    EXPECT_EQ(gone.find(part), std::string::npos) << gone;
  }
}

TEST(RunJudgement, ValuesThatAreNoneAreCountedByKind) {
  RunOutcome outcome;
  outcome.result.faults = {.fixes = 60, .fixes_left_out = 2, .fixes_without_height = 15};
  const RunDescription run;
  const RunStatistics statistics{run.config};
  std::ostringstream said;
  EXPECT_EQ(judge_run(outcome, statistics, run, said), 0);
  for (const char* part : {"warning: 2 of 60 fixes are not finite and were left out",
                           "warning: 15 of 60 fixes have no altitude"}) {
    EXPECT_NE(said.str().find(part), std::string::npos) << said.str();
  }
  const std::string table = summary_table(run, outcome, statistics, RunDetail::brief);
  EXPECT_NE(table.find("values   2 of 60 fixes are not finite and were left out\n"),
            std::string::npos)
      << table;
}

TEST(RunJudgement, TheReportIsBriefUnlessMoreIsWanted) {
  RunDescription run;
  run.output = "my out";
  RunOutcome outcome;
  outcome.result.map.emplace().loops.emplace();
  const RunStatistics statistics{run.config};
  const std::string brief = summary_table(run, outcome, statistics, RunDetail::brief);
  EXPECT_LE(std::ranges::count(brief, '\n'), 8) << brief;
  EXPECT_TRUE(brief.ends_with("next     adit view 'my out'\n")) << brief;
  for (const char* part : {"voxels", "memory", "ms a", "device"}) {
    EXPECT_EQ(brief.find(part), std::string::npos) << brief;
    EXPECT_NE(summary_table(run, outcome, statistics, RunDetail::whole).find(part),
              std::string::npos);
  }
}

TEST(RunJudgement, TheTableHasTheLengthsInForce) {
  RunDescription run;
  run.config.preprocess.r_input = 0.03;
  run.config = with_lengths(run.config);
  EXPECT_NE(said_of(run).find("one point per 0.03 m, submap 0.06 m, returns within 20.7 m\n"),
            std::string::npos)
      << said_of(run);
}

}  // namespace
}  // namespace adit
