// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit run` says of settings that have no effect, or not the one that they state.
#include "adit/tools/run/run_settings.hpp"

#include <string>

#include <gtest/gtest.h>

#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

TEST(RunSettings, WhatTellsOfPacketsNeedsSome) {
  const test::TemporaryFolder folder;
  const auto cloud = folder.write("a.bin", std::string(16, '\0'));
  EXPECT_NO_THROW(require_packets({}, cloud));
  EXPECT_THROW(require_packets({.file = {}, .overrides = {}, .metadata = "sensor.json"}, cloud),
               UsageError);
}

TEST(RunSettings, AReachThatWasCutDownIsToldWhereItWasStated) {
  const Config stated_none = with_lengths(Config{}, 0.05);
  EXPECT_EQ(notes_of({}, stated_none, {}), "");
  Config stated;
  stated.preprocess.c_max = 80.0;
  EXPECT_NE(notes_of(stated, with_lengths(stated, 0.05), {}).find("beyond 41.1 m were dropped"),
            std::string::npos);
  EXPECT_EQ(notes_of(stated, with_lengths(stated, 0.25), {}), "");
}

TEST(RunSettings, OdometryAloneReportsThatItDoesNotUseFixes) {
  const test::TemporaryFolder folder;
  SimulationOptions simulation;
  simulation.scene = "room";
  simulation.duration = 0.5;
  simulation.gnss = gnss_names().front();
  simulation.picture = false;
  simulation.output = folder / "drive.mcap";
  simulate(simulation, {});
  RunCommandOptions options;
  options.recording = simulation.output;
  options.output = folder / "out";
  options.overwrite = true;
  const auto is_reported = [&] {
    const test::Ran run = test::ran(run_command, options);
    EXPECT_EQ(run.code, 0) << run.err;
    return run.err.find("odometry alone does not use the recording's GNSS") != run.err.npos;
  };
  EXPECT_FALSE(is_reported()) << "a run makes a map";
  EXPECT_TRUE(std::filesystem::exists(options.output / "map.adit"));
  options.odometry = true;
  EXPECT_TRUE(is_reported());
  EXPECT_FALSE(std::filesystem::exists(options.output / "map.adit"));
  options.config.overrides = {"gnss.use=false"};
  EXPECT_FALSE(is_reported());
  options.config.overrides = {"mapping.enabled=true"};
  EXPECT_EQ(test::ran(run_command, options).code, 2) << "one excludes the other";
}

}  // namespace
}  // namespace adit
