// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/wanted_run.hpp"

#include <filesystem>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// The working folder is another one for the time of a test.
class InFolder : public testing::Test {
 protected:
  InFolder() { fs::current_path(folder_.path()); }
  ~InFolder() override { fs::current_path(before_); }

  const fs::path before_ = fs::current_path();
  const test::TemporaryFolder folder_;
};

using DefaultOutput = InFolder;

TEST_F(DefaultOutput, IsNamedAfterTheRecording) {
  fs::create_directories("data/drive.d");
  EXPECT_EQ(default_output("data/drive.mcap"), "./drive");
  EXPECT_EQ(default_output("data/drive.d"), "./drive.d") << "a folder has no extension";
  EXPECT_EQ(default_output("data/drive.d/"), "./drive.d");
  EXPECT_EQ(default_output(folder_ / "data/../data/mid.tar.bag"), "./mid.tar");
}

TEST_F(DefaultOutput, IsNeitherTheRecordingNorAFile) {
  fs::create_directories("drive");
  EXPECT_EQ(default_output("drive"), "./drive-out");
  EXPECT_EQ(default_output("drive/"), "./drive-out");
  EXPECT_EQ(default_output("."), "./" + folder_.path().filename().string());
  folder_.write("mid", "a capture without an extension");
  EXPECT_EQ(default_output("mid"), "./mid-out");
}

TEST(WantedRun, OdometryAloneMakesNoMap) {
  const WantedRun run = wanted_run({.recording = "a.mcap", .output = "out", .odometry = true});
  EXPECT_FALSE(load_config(run.options.config).mapping.enabled);
  const WantedRun usual = wanted_run({.recording = "a.mcap", .output = {}});
  EXPECT_TRUE(load_config(usual.options.config).mapping.enabled);
  EXPECT_TRUE(load_config(usual.options.config).mapping.loops);
  EXPECT_EQ(usual.options.output, "./a");
}

TEST(WantedRun, ContinuingExcludesReplacing) {
  RunCommandOptions options{.recording = {}, .output = "out", .continues = true};
  options.overwrite = true;
  EXPECT_THROW(wanted_run(options), UsageError);
  options.overwrite = false;
  options.odometry = true;
  EXPECT_THROW(wanted_run(options), UsageError);
}

}  // namespace
}  // namespace adit
