// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/run_assessment.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tools/report/verdict_text.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

/// A run over a recording of 10 Hz.
struct MadeRun {
  explicit MadeRun(std::size_t count) { description.range.count = count; }

  /// A sweep that was placed well, but for what `change` does.
  template <class Change>
  void place(std::size_t index, const Change& change) {
    SweepResult result;
    result.stamp = milliseconds(100) * static_cast<int64_t>(index);
    result.state = statistics.sweeps() == 0 ? OdometryState::initializing : OdometryState::tracking;
    result.registration.status = RegistrationStatus::converged;
    result.raw_points = result.valid_points = result.cloud_points = 1000;
    for (auto* directions : {&result.registration.translation, &result.registration.rotation}) {
      for (int k = 0; k < 3; ++k) {
        (*directions)[static_cast<std::size_t>(k)] = {.axis = Eigen::Vector3d::Unit(k),
                                                      .localizability = Localizability::full};
      }
    }
    change(result);
    statistics.add(index, Sweep{}, result, {});
  }
  void place(std::size_t index) {
    place(index, [](SweepResult&) {});
  }
  void place_all(std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      place(i);
    }
  }
  void leave_out(std::size_t index, Nanoseconds stamp, Nanoseconds last) {
    Sweep sweep;
    sweep.stamp = stamp;
    static_cast<void>(statistics.left_out().add_sweep(index, sweep, last));
  }

  RunAssessment assessed() const { return assess_run(description, outcome, statistics); }
  std::string text() const { return describe(assessed(), Nanoseconds(0), 9); }
  std::vector<std::string> causes() const {
    std::vector<std::string> causes;
    for (const VerdictReason& reason : assessed().reasons) {
      causes.push_back(reason.cause);
      EXPECT_NE(text().find(reason.text), std::string::npos) << text();
    }
    return causes;
  }

  RunDescription description;
  RunOutcome outcome;
  RunStatistics statistics{Config{}};
};

using Causes = std::vector<std::string>;

TEST(RunAssessment, AWholeRecordingWithoutDoubtIsReliable) {
  MadeRun run(100);
  run.place_all(0, 100);
  EXPECT_EQ(run.assessed().trust, Trust::reliable);
  EXPECT_EQ(run.text(), "reliable: no sweep is in doubt");
  EXPECT_EQ(run.assessed().coverage.missing(), 0U);
}

TEST(RunAssessment, AFewDamagedSweepsOfHundredsAreStatedAndChangeNothing) {
  MadeRun run(300);
  for (std::size_t i = 0; i < 300; ++i) {
    if (i % 60 != 30) {
      run.place(i);
    }
  }
  EXPECT_EQ(run.assessed().trust, Trust::reliable);
  EXPECT_EQ(run.text(),
            "reliable: no sweep is in doubt; 5 of 300 sweeps are not in the trajectory");
}

TEST(RunAssessment, AnEndThatIsMissingIsDoubtful) {
  MadeRun run(50);
  run.place_all(0, 7);
  EXPECT_EQ(run.assessed().trust, Trust::doubtful);
  EXPECT_EQ(run.causes(), Causes{"missing sweeps"});
  EXPECT_NE(
      run.text().find("43 of 50 sweeps are not in the trajectory, 43 of them in a row (4.3 s)"),
      std::string::npos)
      << run.text();
  MadeRun begins_late(300);
  begins_late.place_all(15, 300);
  EXPECT_EQ(begins_late.causes(), Causes{"missing sweeps"});
  MadeRun hardly(300);
  hardly.place_all(0, 292);
  EXPECT_EQ(hardly.assessed().trust, Trust::reliable) << "0.8 s";
}

// Each is bridged, and still a quarter of what was recorded is not used.
TEST(RunAssessment, ManySweepsThatAreMissingOneByOneAreDoubtful) {
  MadeRun run(400);
  for (std::size_t i = 0; i < 400; ++i) {
    if (i % 4 != 2) {
      run.place(i);
    }
  }
  EXPECT_EQ(run.causes(), Causes{"missing sweeps"});
}

TEST(RunAssessment, WhatWasLeftOutBeyondTheCountIsMissingToo) {
  MadeRun run(50);
  run.place_all(0, 50);
  for (std::size_t i = 50; i < 100; ++i) {
    run.leave_out(i, milliseconds(100) * i - std::chrono::hours(1), milliseconds(4900));
  }
  const Coverage coverage = run.assessed().coverage;
  EXPECT_EQ(coverage.sweeps, 100U);
  EXPECT_EQ(coverage.placed, 50U);
  EXPECT_EQ(coverage.longest, 50U);
  EXPECT_NEAR(coverage.longest_seconds, 5.0, 1e-9);
}

TEST(RunAssessment, ARecordingThatEndsDamagedIsDoubtfulAndOneThatGoesOnIsNot) {
  MadeRun run(30);
  run.place_all(0, 30);
  LeftOut& left_out = run.statistics.left_out();
  static_cast<void>(left_out.add_damage(InputError("a.mcap", {}, "a chunk", "Copy it"), "/points"));
  EXPECT_EQ(run.causes(), Causes{"cut off"});
  left_out.note_read();
  EXPECT_EQ(run.causes(), Causes());
  EXPECT_EQ(run.assessed().trust, Trust::reliable);
}

// It declares how many sweeps it has: what is missing is known, and little.
TEST(RunAssessment, TheLastSweepOfManyMayBeDamaged) {
  MadeRun run(30);
  run.place_all(0, 29);
  static_cast<void>(run.statistics.left_out().add_damage(
      InputError("a.mcap", {}, "a message", "Copy it"), "/points"));
  EXPECT_EQ(run.assessed().trust, Trust::reliable);
  EXPECT_EQ(run.assessed().coverage.missing(), 1U);
}

TEST(RunAssessment, AClockThatIsSetBackIsNamedWithItsSweep) {
  MadeRun run(100);
  run.place_all(0, 50);
  for (std::size_t i = 50; i < 100; ++i) {
    run.leave_out(i, milliseconds(100) * i - std::chrono::hours(1), milliseconds(4900));
  }
  EXPECT_EQ(run.causes(), (Causes{"clock", "missing sweeps"}));
  for (const char* part : {"clock was set back by 3599.9 s at sweep 50", "`--start 50`"}) {
    EXPECT_NE(run.text().find(part), std::string::npos) << run.text();
    EXPECT_NE(run.statistics.left_out().text().find(part), std::string::npos);
  }
  ASSERT_EQ(run.statistics.left_out().clock_steps().size(), 1U);
}

TEST(RunAssessment, EachStepOfTheClockIsNamedAndLateSweepsAreNone) {
  MadeRun run(100);
  run.place_all(0, 40);
  run.leave_out(40, milliseconds(3800), milliseconds(3900));
  run.leave_out(59, milliseconds(5800), milliseconds(5900));
  run.leave_out(60, milliseconds(1000), milliseconds(5900));
  run.leave_out(61, milliseconds(1100), milliseconds(5900));
  run.leave_out(62, milliseconds(-9000), milliseconds(5900));
  run.leave_out(80, milliseconds(0), milliseconds(7900));
  const std::vector<SweepClockStep>& steps = run.statistics.left_out().clock_steps();
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0].sweep, 60U);
  EXPECT_NEAR(steps[0].back, 4.9, 1e-9);
  EXPECT_EQ(steps[1].sweep, 62U) << "set back again";
  EXPECT_EQ(steps[2].sweep, 80U);
  const auto json = run.statistics.left_out().to_json();
  EXPECT_EQ(json["clock_set_back"].size(), 3U);
  EXPECT_EQ(json["clock_set_back"][2]["sweep"], 80);
}

TEST(RunAssessment, OneSweepAloneWasNotChecked) {
  MadeRun run(1);
  run.place(0);
  EXPECT_EQ(run.assessed().trust, Trust::doubtful);
  EXPECT_EQ(run.causes(), Causes{"not checked"});
}

TEST(RunAssessment, WhereNoSweepIsAlignedTheRunIsLost) {
  MadeRun run(3);
  run.place(0);
  for (std::size_t i = 1; i < 3; ++i) {
    run.place(i, [](SweepResult& result) {
      result.state = OdometryState::coasting;
      result.registration.status = RegistrationStatus::too_little_overlap;
    });
  }
  EXPECT_EQ(run.assessed().trust, Trust::lost);
  EXPECT_EQ(run.causes(), Causes{"not aligned"});
}

/// A run of which the IMU was in these states.
MadeRun run_with_imu(const std::vector<InertialState>& states) {
  MadeRun run(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    run.statistics.add(ImuArrival::appended);
    run.place(i, [&](SweepResult& result) { result.inertial.state = states[i]; });
  }
  return run;
}

std::vector<InertialState> states(std::vector<std::pair<InertialState, int>> parts) {
  std::vector<InertialState> all;
  for (const auto& [state, count] : parts) {
    all.insert(all.end(), static_cast<std::size_t>(count), state);
  }
  return all;
}

TEST(RunAssessment, AnImuThatIsRejectedOrNeverFusedIsDoubtful) {
  using enum InertialState;
  const Causes rejected{"imu rejected"};
  EXPECT_EQ(run_with_imu(states({{starting, 10}, {fused, 50}})).causes(), Causes());
  EXPECT_EQ(run_with_imu(states({{starting, 20}})).causes(), Causes()) << "of two seconds";
  EXPECT_EQ(run_with_imu(states({{fused, 50}, {lost, 5}, {fused, 50}})).causes(), Causes());
  EXPECT_EQ(run_with_imu(states({{starting, 10}, {fused, 90}, {refused, 10}})).causes(), rejected);
  EXPECT_EQ(run_with_imu(states({{starting, 10}, {fused, 20}, {lost, 60}})).causes(), rejected);
  EXPECT_EQ(run_with_imu(states({{starting, 150}})).causes(), rejected);
  EXPECT_EQ(run_with_imu(states({{absent, 20}})).causes(), rejected) << "no reading was usable";
}

TEST(RunAssessment, PartsThatNothingTiesAreDoubtfulAndThoseThatALoopTiesAreNotLost) {
  MadeRun run(20);
  run.place_all(0, 10);
  run.place(10, [](SweepResult& result) {
    result.state = OdometryState::restarted;
    result.registration.status = RegistrationStatus::doubtful;
    result.silence = 15.0;
  });
  run.place_all(11, 20);
  EXPECT_EQ(run.assessed().trust, Trust::lost);
  EXPECT_NE(run.text().find("no sweep was aligned for 15.0 s"), std::string::npos) << run.text();
  run.outcome.result.map.emplace().components = 2;
  EXPECT_EQ(run.assessed().trust, Trust::lost);
  EXPECT_EQ(run.causes(), Causes{"parts"});
  run.outcome.result.map->components = 1;
  EXPECT_EQ(run.assessed().trust, Trust::doubtful);
  EXPECT_EQ(run.causes(), Causes());
  EXPECT_NE(run.text().find("loops or GNSS alone tie its pieces"), std::string::npos) << run.text();
}

TEST(RunAssessment, ARunThatEndedEarlyIsDoubtful) {
  MadeRun run(100);
  run.place_all(0, 99);
  run.outcome.result.end = RunEnd::interrupted;
  run.outcome.result.reason = "stopped by a signal";
  EXPECT_EQ(run.causes(), Causes{"ended early"});
}

TEST(RunAssessment, TheJsonHasCoverageReasonsAndStretches) {
  MadeRun run(50);
  run.place_all(0, 7);
  const auto json = to_json(run.assessed(), Nanoseconds(0));
  EXPECT_EQ(json["state"], "doubtful");
  EXPECT_EQ(json["coverage"]["sweeps"], 50);
  EXPECT_EQ(json["coverage"]["placed"], 7);
  EXPECT_EQ(json["coverage"]["missing"], 43);
  EXPECT_EQ(json["coverage"]["longest_missing"], 43);
  EXPECT_NEAR(json["coverage"]["longest_missing_s"].get<double>(), 4.3, 1e-9);
  ASSERT_EQ(json["reasons"].size(), 1U);
  EXPECT_EQ(json["reasons"][0]["cause"], "missing sweeps");
  EXPECT_EQ(json["reasons"][0]["state"], "doubtful");
  EXPECT_FALSE(json["reasons"][0]["text"].get<std::string>().empty());
  EXPECT_TRUE(json["stretches"].empty());
}

}  // namespace
}  // namespace adit
