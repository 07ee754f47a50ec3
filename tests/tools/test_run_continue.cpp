// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit run --continue` and `adit run --from`.
#include <fstream>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/run/earlier_run.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

using test::Ran;

Ran ran(const RunCommandOptions& options) {
  return test::ran(run_command, options);
}

std::string dump_of(const fs::path& file) {
  return test::dump_of(MapDatabase(file, MapAccess::read));
}

class RunContinue : public testing::Test {
 protected:
  RunContinue() : recording_(test::small_recording(folder_.path(), 8).recording) {
    first_.recording = recording_;
    first_.output = folder_ / "out";
    first_.map.enabled = false;
    first_.config.overrides = {"preprocess.beam_spacing=0.03", "mapping.loops=false",
                               "keyframe.delta_trans=0.05"};
    EXPECT_EQ(ran(first_).code, 0);
  }

  RunCommandOptions continuing() const {
    RunCommandOptions options;
    options.output = folder_ / "out";
    options.map.enabled = false;
    options.continues = true;
    return options;
  }
  /// As a run leaves it that was interrupted behind its last sweep.
  void make_incomplete() const {
    const SqliteDatabase raw(map(), SqliteDatabase::Mode::update);
    raw.execute("UPDATE sessions SET complete = 0");
  }
  fs::path map() const { return folder_ / "out/map.adit"; }

  const test::TemporaryFolder folder_;
  fs::path recording_;
  RunCommandOptions first_;
};

TEST_F(RunContinue, WhatIsCompleteStaysAsItIs) {
  const std::string before = test::content(map());
  const Ran again = ran(continuing());
  EXPECT_EQ(again.code, 0);
  EXPECT_NE(again.err.find("is complete"), std::string::npos) << again.err;
  EXPECT_EQ(test::content(map()), before);
}

TEST_F(RunContinue, MoreMemoryThanBeforeMakesTheSameMap) {
  constexpr uint64_t kGibibyte = uint64_t{1} << 30U;
  RunCommandOptions bounded = first_;
  bounded.output = folder_ / "out";
  bounded.overwrite = true;
  bounded.max_ram_bytes = 4 * kGibibyte;
  ASSERT_EQ(ran(bounded).code, 0);
  EXPECT_EQ(earlier_run(map()).graph_bytes, kGibibyte / 4);
  const std::string whole = dump_of(map());
  make_incomplete();
  RunCommandOptions more = continuing();
  more.max_ram_bytes = 8 * kGibibyte;
  const Ran again = ran(more);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(dump_of(map()), whole);
  EXPECT_EQ(earlier_run(map()).graph_bytes, kGibibyte / 4);
}

TEST_F(RunContinue, ARunThatWasStoppedEndsAsOneThatWasNot) {
  const std::string whole = dump_of(map());
  const std::string poses = test::content(folder_ / "out/trajectory.tum");
  make_incomplete();
  const Ran again = ran(continuing());
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_NE(again.err.find("from where it ends it grows"), std::string::npos) << again.err;
  EXPECT_EQ(dump_of(map()), whole);
  EXPECT_EQ(test::content(folder_ / "out/trajectory.tum"), poses);
  EXPECT_TRUE(earlier_run(map()).progress.complete);
  EXPECT_TRUE(test::json_of(folder_ / "out/summary.json").at("continued"));
}

// From the comparison up to the exit code: nothing of it may end the process.
TEST_F(RunContinue, AMapThatTheRunDoesNotMakeIsToldAndStays) {
  make_incomplete();
  {
    const SqliteDatabase raw(map(), SqliteDatabase::Mode::update);
    raw.execute("UPDATE keyframes SET stamp_ns = stamp_ns + 1 WHERE id = 1");
  }
  const std::string before = dump_of(map());
  const Ran again = ran(continuing());
  EXPECT_EQ(again.code, 1);
  EXPECT_NE(again.err.find("keyframe 1: it is not what this run makes"), std::string::npos)
      << again.err;
  EXPECT_EQ(dump_of(map()), before);
  EXPECT_EQ(test::json_of(folder_ / "out/summary.json").at("status"), "input_error");
}

TEST_F(RunContinue, TheMapShowsThatTheFolderIsARunsWhereTheSummaryIsGone) {
  make_incomplete();
  fs::remove(folder_ / "out/summary.json");
  const Ran again = ran(continuing());
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_TRUE(earlier_run(map()).progress.complete);
}

TEST_F(RunContinue, AnotherRecordingIsRefusedAndTheMapStays) {
  make_incomplete();
  const std::string before = dump_of(map());
  const fs::path sweep = recording_ / "velodyne/000003.bin";
  {
    std::fstream file(sweep, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(40);
    file.put('\7');
  }
  const Ran again = ran(continuing());
  EXPECT_EQ(again.code, 1);
  EXPECT_NE(again.err.find("recording fingerprint"), std::string::npos) << again.err;
  EXPECT_EQ(dump_of(map()), before);
}

TEST_F(RunContinue, ARecordingThatWasMovedAndRenamedIsTheSame) {
  make_incomplete();
  const std::string whole = dump_of(map());
  fs::create_directories(folder_ / "archive");
  fs::rename(recording_, folder_ / "archive/street");
  const Ran missing = ran(continuing());
  EXPECT_EQ(missing.code, 1);
  EXPECT_NE(missing.err.find("is not there"), std::string::npos) << missing.err;
  RunCommandOptions options = continuing();
  options.recording = folder_ / "archive/street";
  const Ran again = ran(options);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(dump_of(map()), whole);
  EXPECT_TRUE(earlier_run(map()).progress.complete);
}

TEST(SessionOf, NeitherNamesNorPlacesSayWhatARecordingIs) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "scan.pcap") << "packets";
  std::ofstream(folder / "sensor.json") << "{}";
  fs::create_directories(folder / "scans");
  RunDescription run;
  run.recording = folder / "scan.pcap";
  run.recording_description = run.recording.string() + ": capture of a sensor";
  run.topic = "/points";
  run.config.recording.metadata = fs::relative(folder / "sensor.json").string();
  const MapSession first = session_of(run);
  EXPECT_NE(first.configuration.find("metadata = \"/"), std::string::npos) << "from any folder";
  EarlierRun earlier;
  earlier.session = first;

  fs::rename(folder / "scan.pcap", folder / "scans/other.pcap");
  fs::rename(folder / "sensor.json", folder / "scans/renamed.json");
  run.recording = folder / "scans/other.pcap";
  run.recording_description = run.recording.string() + ": capture of a sensor";
  run.config.recording.metadata = (folder / "scans/renamed.json").string();
  EXPECT_NO_THROW(require_same(earlier, session_of(run)));

  std::ofstream(folder / "scans/renamed.json") << "{\"beams\": 64}";
  try {
    require_same(earlier, session_of(run));
    FAIL() << "another sensor";
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("metadata fingerprint"), std::string::npos) << error.found();
  }
}

TEST_F(RunContinue, AMapThatWasEditedIsRefused) {
  make_incomplete();
  MapDatabase(map(), MapAccess::write).revise({});
  const Ran again = ran(continuing());
  EXPECT_EQ(again.code, 1);
  EXPECT_NE(again.err.find("written to since its run"), std::string::npos) << again.err;
}

TEST_F(RunContinue, WhatChoosesOtherSettingsOrHasNoMapIsAUsageError) {
  RunCommandOptions other = continuing();
  other.config.overrides = {"mapping.loops=true"};
  EXPECT_EQ(ran(other).code, 2);
  other = continuing();
  other.start = 2;
  EXPECT_EQ(ran(other).code, 2);
  other = continuing();
  other.output = folder_ / "elsewhere";
  const Ran none = ran(other);
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("holds no map.adit"), std::string::npos) << none.err;
  EXPECT_EQ(ran(RunCommandOptions{.recording = {}, .output = folder_ / "x"}).code, 2);
}

TEST_F(RunContinue, FromAMapTakesItsRecordingAndSettings) {
  RunCommandOptions options;
  options.output = folder_ / "finer";
  options.map.enabled = false;
  options.from = map();
  options.config.overrides = {"mapping.r_submap=0.125"};
  const Ran again = ran(options);
  EXPECT_EQ(again.code, 0) << again.err;
  const EarlierRun made = earlier_run(folder_ / "finer/map.adit");
  EXPECT_EQ(made.recording, recording_);
  const Config config = parse_config(made.session.configuration, made.map);
  EXPECT_EQ(config.mapping.r_submap, 0.125);
  EXPECT_EQ(config.keyframe.delta_trans, 0.05) << "as the map says";
  EXPECT_EQ(test::content(folder_ / "finer/odometry.tum"),
            test::content(folder_ / "out/odometry.tum"));
}

TEST_F(RunContinue, FromAMapDoesNotReplaceIt) {
  RunCommandOptions options;
  options.output = folder_ / "out";
  options.from = map();
  const std::string before = dump_of(map());
  const Ran again = ran(options);
  EXPECT_EQ(again.code, 2);
  EXPECT_NE(again.err.find("which it is made from"), std::string::npos) << again.err;
  EXPECT_EQ(dump_of(map()), before);
}

TEST_F(RunContinue, TooLittleMemoryIsAUsageErrorAndEnoughIsReported) {
  RunCommandOptions options = first_;
  options.output = folder_ / "little";
  options.max_ram_bytes = uint64_t{40} << 20U;
  EXPECT_EQ(ran(options).code, 2);
  EXPECT_FALSE(fs::exists(folder_ / "little/summary.json"));
  options.max_ram_bytes = uint64_t{1} << 40U;
  EXPECT_EQ(ran(options).code, 0);
  const nlohmann::json json = test::json_of(folder_ / "little/summary.json");
  EXPECT_EQ(json.at("memory").at("max_ram_bytes"), uint64_t{1} << 40U);
  EXPECT_GT(json.at("memory").at("resident_peak_bytes"), uint64_t{1} << 20U);
}

// The device's memory does not suffice in the middle of a run: it ends, what it has stored is a
// whole map, and with more of it the run goes on.
TEST_F(RunContinue, ARunWhoseDeviceHasTooLittleMemoryKeepsWhatItHasStored) {
  const std::string whole = dump_of(map());
  const uint64_t peak =
      test::json_of(folder_ / "out/summary.json").at("device").at("memory_peak_bytes");
  fs::remove_all(folder_ / "out");
  RunCommandOptions small = first_;
  small.device.max_vram_bytes = peak - 1;
  const Ran ended = ran(small);
  EXPECT_EQ(ended.code, 1) << ended.out;
  EXPECT_NE(ended.err.find("budget"), std::string::npos) << ended.err;
  const nlohmann::json summary = test::json_of(folder_ / "out/summary.json");
  EXPECT_EQ(summary.at("status"), "device_error");
  EXPECT_EQ(summary.at("device").at("memory_budget_bytes"), peak - 1);
  EXPECT_LT(summary.at("device").at("memory_peak_bytes"), peak);
  EXPECT_TRUE(MapDatabase(map(), MapAccess::read).check().empty());
  EXPECT_EQ(ran(continuing()).code, 0);
  EXPECT_EQ(dump_of(map()), whole);
}

TEST_F(RunContinue, DifferencesAreNamed) {
  const EarlierRun earlier = earlier_run(map());
  MapSession now = earlier.session;
  EXPECT_NO_THROW(require_same(earlier, now));
  now.configuration += "\n[keyframe]\nodd = 1.0\n";
  for (auto& [key, value] : now.provenance) {
    value += key == "device" || key == "recording" ? " of another kind" : "";
  }
  try {
    require_same(earlier, now);
    FAIL() << "they differ";
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("device: "), std::string::npos) << error.found();
    EXPECT_NE(error.found().find("the setting keyframe.odd = 1.0"), std::string::npos);
    EXPECT_EQ(error.found().find("recording:"), std::string::npos) << "it may have been moved";
  }
}

}  // namespace
}  // namespace adit
