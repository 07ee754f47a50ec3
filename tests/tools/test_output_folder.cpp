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
#include "adit/tools/map_database/writer_lock.hpp"
#include "adit/tools/results/run_outputs.hpp"
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

TEST(OutputFolder, ResultsOfAnEarlierRunAreNotReplacedUnasked) {
  const test::TemporaryFolder folder;
  EXPECT_NO_THROW(require_no_results(folder / "none"));
  folder.write("summary.json", kSummary);
  folder.write("trajectory.tum", "");
  folder.write("notes.txt", "mine");
  EXPECT_NO_THROW(require_no_results(folder.path())) << "a run that left nothing";
  folder.write("map.adit", "keyframes");
  try {
    require_no_results(folder.path());
    FAIL() << "the map would be lost";
  } catch (const UsageError& error) {
    for (const char* part : {"map.adit", "--overwrite", "--continue"}) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
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
  options.overwrite = true;
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

class RunInto : public testing::Test {
 protected:
  RunInto() {
    options_.recording = test::small_recording(folder_.path(), 3).recording;
    options_.output = folder_ / "out";
    options_.overwrite = true;
    options_.config.overrides = {"preprocess.beam_spacing=0.03"};
  }

  /// Of the files that a run leaves.
  std::vector<std::string> contents() const {
    std::vector<std::string> texts;
    for (const fs::path& file : result_files(options_.output)) {
      texts.push_back(test::content(file));
    }
    return texts;
  }

  test::TemporaryFolder folder_;
  RunCommandOptions options_;
};

TEST_F(RunInto, AFolderThatAnotherWritesIsRefused) {
  const fs::path summary = options_.output / "summary.json";
  folder_.write("out/summary.json.lock", "of a run that was killed");
  ASSERT_EQ(test::ran(run_command, options_).code, 0);
  EXPECT_FALSE(fs::exists(summary.string() + ".lock"));
  const std::vector<std::string> before = contents();
  {
    const WriterLock other(summary);
    const test::Ran second = test::ran(run_command, options_);
    EXPECT_EQ(second.code, 1);
    EXPECT_NE(second.err.find("is being written by process"), std::string::npos) << second.err;
  }
  EXPECT_EQ(contents(), before);
  EXPECT_EQ(test::ran(run_command, options_).code, 0);
}

TEST_F(RunInto, WhatEndsAtTheFirstSweepsTakesNoEarlierRunAway) {
  ASSERT_EQ(test::ran(run_command, options_).code, 0);
  const std::vector<std::string> before = contents();
  RunCommandOptions small = options_;
  small.device.max_vram_bytes = 1024;
  const test::Ran memory = test::ran(run_command, small);
  EXPECT_EQ(memory.code, 1);
  for (const char* part : {"the budget is 1024, where at least ", "--max-vram"}) {
    EXPECT_NE(memory.err.find(part), std::string::npos) << memory.err;
  }
  EXPECT_EQ(contents(), before);
  RunCommandOptions damaged = options_;
  damaged.recording = folder_.write("zero.pcd", "");
  const test::Ran empty = test::ran(run_command, damaged);
  EXPECT_EQ(empty.code, 1);
  EXPECT_NE(empty.err.find("zero.pcd"), std::string::npos) << empty.err;
  EXPECT_EQ(contents(), before);
}

TEST(CheckWritable, TheAdviceIsOfTheFileThatCannotBeWritten) {
  const test::TemporaryFolder folder;
  const auto refusal_of_other = [&](const fs::path& other) -> std::string {
    try {
      check_writable(folder / "out", {}, {other});
    } catch (const OutputError& error) {
      return error.what();
    }
    return {};
  };
  const std::string elsewhere = refusal_of_other(folder / "none" / "t.html");
  EXPECT_TRUE(elsewhere.ends_with("Name another file.")) << elsewhere;
  fs::create_directories(folder / "out/odometry.tum");
  const std::string inside = refusal_of_other(folder / "out" / "odometry.tum");
  EXPECT_TRUE(inside.ends_with("Choose another folder with -o.")) << inside;
}

}  // namespace
}  // namespace adit
