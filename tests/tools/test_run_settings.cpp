// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit run` says of settings that have no effect, or not the one that they state.
#include "adit/tools/commands/run_settings.hpp"

#include <string>

#include <gtest/gtest.h>

#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

TEST(RunSettings, LoopsNeedAMap) {
  Config config;
  config.mapping.loops = true;
  EXPECT_THROW(require_map_for_loops(config), UsageError);
  config.mapping.enabled = true;
  EXPECT_NO_THROW(require_map_for_loops(config));
}

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

TEST(RunSettings, FixesWithoutAMapAreToldToBeLeftOut) {
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
  EXPECT_NE(test::ran(run_command, options).err.find("a map alone has a use for them"),
            std::string::npos);
  options.config.overrides = {"gnss.use=false"};
  EXPECT_EQ(test::ran(run_command, options).err.find("GNSS fixes"), std::string::npos);
  options.config.overrides = {"mapping.loops=true"};
  const test::Ran loops = test::ran(run_command, options);
  EXPECT_EQ(loops.code, 2);
  EXPECT_NE(loops.err.find("set mapping.enabled=true"), std::string::npos) << loops.err;
}

}  // namespace
}  // namespace adit
