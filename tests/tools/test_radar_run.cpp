// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A radar with an IMU, from the recording to the trajectory.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_inspect.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/simulator/simulation.hpp"

namespace adit {
namespace {

TEST(RadarRun, PlacesEveryScanAndSaysThatItIsExperimental) {
  const test::TemporaryFolder folder;
  SimulationOptions simulation;
  simulation.scene = "mine";
  simulation.trajectory = "drive";
  simulation.duration = 6.0;
  simulation.picture = false;
  simulation.lidars.front().sensor = "radar-4d";
  simulation.output = folder / "radar.mcap";
  const SimulationSummary made = simulate(simulation, {});
  InspectCommandOptions inspect;
  inspect.recording = simulation.output;
  const test::Ran seen = test::ran(inspect_command, inspect);
  EXPECT_NE(seen.out.find("a radar (few points, with Doppler speeds; experimental)"),
            std::string::npos)
      << seen.out;
  EXPECT_EQ(seen.out.find("no time per point"), std::string::npos) << seen.out;
  RunCommandOptions options;
  options.recording = simulation.output;
  options.output = folder / "out";
  const test::Ran run = test::ran(run_command, options);
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_NE((run.out + run.err).find("scans of a radar: mapping with them is experimental"),
            std::string::npos)
      << run.out << run.err;
  const nlohmann::json summary = test::json_of(folder / "out" / "summary.json");
  EXPECT_EQ(summary["verdict"]["coverage"]["placed"], 120);
  EXPECT_GE(summary["velocity"]["doppler"]["fused"], 80);
  const double path = summary["distance_m"];
  EXPECT_NEAR(path, made.path, 0.1 * made.path);
}

}  // namespace
}  // namespace adit
