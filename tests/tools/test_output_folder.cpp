// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// An output folder holds one run, and nothing else is lost in it.
#include "adit/tools/results/output_folder.hpp"

#include <filesystem>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/drawing/html_page.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummary = R"({"adit": "0.1.0", "status": "completed"})";

/// The message of the refusal; empty where there is none.
std::string refusal(const fs::path& recording, const fs::path& folder) {
  try {
    check_output_folder(recording, folder);
  } catch (const UsageError& error) {
    return error.what();
  }
  return {};
}

TEST(OutputFolder, RecordingItselfAndWhatLiesInsideItAreRefused) {
  const test::TemporaryFolder folder;
  const fs::path recording = folder / "drive";
  fs::create_directories(recording / "velodyne");
  fs::create_directory_symlink(recording, folder / "link");
  for (const fs::path& out : {recording, recording / "", recording / "velodyne", recording / "out",
                              folder / "link", folder / "link/out", folder / "link/../drive/a/b"}) {
    EXPECT_NE(refusal(recording, out).find("into the recording"), std::string::npos) << out;
    EXPECT_NE(refusal(folder / "link", out).find("into the recording"), std::string::npos) << out;
  }
  EXPECT_EQ(refusal(recording, folder / "drive2"), "");
  EXPECT_EQ(refusal(recording, folder.path()), "") << "a recording may lie in the folder";
}

TEST(OutputFolder, RecordingThatAResultWouldReplaceIsRefused) {
  const test::TemporaryFolder folder;
  folder.write("summary.json", kSummary);
  const fs::path map = folder.write("map.ply", "points");
  EXPECT_NE(refusal(map, folder.path()).find("would replace the recording"), std::string::npos);
  fs::create_symlink(map, folder / "other.ply");
  EXPECT_NE(refusal(folder / "other.ply", folder.path()).find("would replace the recording"),
            std::string::npos);
  EXPECT_NE(refusal(map, map).find("into the recording"), std::string::npos);
}

TEST(OutputFolder, FileThatNoRunWroteIsNotReplaced) {
  const test::TemporaryFolder folder;
  folder.write("notes.txt", "mine");
  EXPECT_EQ(refusal("drive.mcap", folder.path()), "");
  folder.write("trajectory.tum", "mine");
  EXPECT_NE(refusal("drive.mcap", folder.path()).find("trajectory.tum is there"),
            std::string::npos);
  folder.write("summary.json", R"({"status": "of another program"})");
  EXPECT_NE(refusal("drive.mcap", folder.path()), "");
  folder.write("summary.json", kSummary);
  EXPECT_EQ(refusal("drive.mcap", folder.path()), "");
  EXPECT_TRUE(check_output_folder("drive.mcap", folder.path()));
}

TEST(OutputFolder, EarlierRunIsRemovedAsAWholeAndNothingElse) {
  const test::TemporaryFolder folder;
  for (const char* name : {"trajectory.tum", "map.ply", "odometry_highrate.csv", "notes.txt"}) {
    folder.write(name, "earlier");
  }
  folder.write("evaluation.html", html_page("a run", ""));
  folder.write("map.svg", "<svg>drawn by hand</svg>");
  remove_earlier_run(folder.path());
  for (const char* name :
       {"trajectory.tum", "map.ply", "odometry_highrate.csv", "evaluation.html"}) {
    EXPECT_FALSE(fs::exists(folder / name)) << name;
  }
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
  EXPECT_TRUE(fs::exists(folder / "map.svg")) << "not ours";
}

/// The whole command: the second run has no map, no high rate and fewer sweeps.
TEST(OutputFolder, SecondRunLeavesNothingOfTheFirst) {
  const test::TemporaryFolder folder;
  RunCommandOptions options;
  options.recording = test::small_recording(folder.path(), 3).recording;
  options.output = folder / "out";
  options.config.overrides = {"preprocess.beam_spacing=0.03"};
  options.high_rate.enabled = true;
  std::ostringstream said;
  ASSERT_EQ(run_command(options, said, said), 0) << said.str();
  std::ofstream(options.output / "evaluation.html") << html_page("the first run", "");
  std::ofstream(options.output / "notes.txt") << "mine";
  options.high_rate.enabled = false;
  options.map.enabled = false;
  options.count = 2;
  ASSERT_EQ(run_command(options, said, said), 0) << said.str();
  for (const char* name :
       {"map.ply", "odometry_highrate.tum", "odometry_highrate.csv", "evaluation.html"}) {
    EXPECT_FALSE(fs::exists(options.output / name)) << name;
  }
  EXPECT_EQ(test::lines(options.output / "trajectory.tum"), 2U);
  EXPECT_EQ(test::content(options.output / "notes.txt"), "mine");
  options.output = options.recording;
  EXPECT_EQ(run_command(options, said, said), 2) << said.str();
  EXPECT_FALSE(fs::exists(options.recording / "trajectory.tum"));
}

}  // namespace
}  // namespace adit
