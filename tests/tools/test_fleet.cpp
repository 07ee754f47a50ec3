// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Fleets: their files, plans, and shards that fail in all ways. A script stands in for adit.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/fleet/fleet_file.hpp"
#include "adit/tools/fleet/fleet_plan.hpp"
#include "adit/tools/fleet/fleet_stages.hpp"
#include "adit/tools/fleet/fleet_status.hpp"
#include "adit/tools/fleet/job_scripts.hpp"
#include "adit/tools/fleet/map_places.hpp"
#include "adit/tools/fleet/shard_run.hpp"
#include "adit/tools/fleet/shared_files.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

class FleetTest : public ::testing::Test {
 protected:
  FleetTest() {
    for (const char* const name : {"a/drive.mcap", "b/drive.mcap", "b/walk.mcap"}) {
      folder.write(name, name);
    }
    folder.write("adit", "#!/bin/sh\nexit 0\n");
  }

  std::string refusal(const std::string& text) const {
    try {
      read_fleet(folder.write("fleet.toml", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  FleetPlan planned(const std::string& text = "recordings = [\"*/*.mcap\"]\n") const {
    const FleetPlan plan =
        plan_fleet(read_fleet(folder.write("fleet.toml", text)), folder / "plan");
    write_plan(plan);
    return plan;
  }

  /// What `adit` does from now on: $* are its words.
  void program_does(const std::string& text) const {
    const fs::path file = folder.write("adit", "#!/bin/sh\n" + text);
    fs::permissions(file, fs::perms::owner_all);
  }

  int run(const FleetPlan& plan, std::size_t shard) {
    std::ostringstream out;
    std::ostringstream err;
    const int code = run_shard(plan, plan.shards.at(shard), {.program = folder / "adit"}, out, err);
    said = out.str() + err.str();
    return code;
  }

  /// In a process of its own, as in life.
  int run_apart(const FleetPlan& plan, std::size_t shard) {
    const pid_t process = fork();
    if (process == 0) {
      _exit(run(plan, shard));
    }
    int status = 0;
    EXPECT_EQ(waitpid(process, &status, 0), process);
    return WEXITSTATUS(status);
  }

  /// `adit run` makes a map from now on.
  void program_makes_a_map() const {
    test::write_full_map(folder / "made.adit");
    program_does("[ \"$1 $3\" = \"run -o\" ] && mkdir -p \"$4\" && cp " +
                 (folder / "made.adit").string() + " \"$4/map.adit\"\n");
  }

  ShardState state(const FleetPlan& plan, std::size_t shard) const {
    return standings_of(plan, FleetStage::report).at(shard).state;
  }

  test::TemporaryFolder folder;
  std::string said;
};

TEST_F(FleetTest, ItsFileNamesRecordingsAndOptions) {
  const Fleet fleet = read_fleet(folder.write("fleet.toml", R"(
recordings = ["a/*.mcap"]
run = "--no-map --config my.toml"
[[recording]]
path = ["b/drive.mcap", "b/walk.mcap"]
name = "both"
run = ["--set", "a.b=with blank"]
[merge]
same_site = true
shards = 3
[deliver]
crs = "EPSG:25832"
)"));
  ASSERT_EQ(fleet.recordings.size(), 2U);
  EXPECT_EQ(fleet.recordings[0].name, "both");
  EXPECT_EQ(fleet.recordings[0].parts.size(), 2U);
  EXPECT_EQ(fleet.recordings[0].options.back(), "a.b=with blank");
  EXPECT_EQ(fleet.recordings[0].options.size(), 5U);
  EXPECT_EQ(fleet.recordings[1].parts.front(), folder / "a/drive.mcap");
  EXPECT_TRUE(fleet.same_site);
  EXPECT_EQ(fleet.pair_shards, 3U);
  EXPECT_EQ(fleet.place.crs, "EPSG:25832");
  EXPECT_GT(fleet.products.size(), 5U);
}

TEST_F(FleetTest, MistakesInItsFileAreNamedWithTheirLine) {
  for (const auto& [text, part] :
       {std::pair("a = ", "line 1: it is no TOML"), std::pair("", "fewer than two recordings"),
        std::pair("recordings = [\"a/*.mcap\"]", "fewer than two recordings"),
        std::pair("recordings = 3", "recordings is no list of texts"),
        std::pair("recordings = [\"c/*.mcap\"]", "there is no "),
        std::pair("[[recording]]\npath = \"a/drive.mcap\"\n[[recording]]\npath = \"a/*\"",
                  "line 3: "),
        std::pair("[[recording]]\npath = [\"a/drive.mcap\", \"a/*\"]", "is named twice"),
        std::pair("record = []", "line 1: a fleet has no record: recordings, run,"),
        std::pair("[[recording]]\nname = \"a\"", "a recording has no path"),
        std::pair("[[recording]]\npath = \"a/drive.mcap\"\nname = \"../a\"",
                  "'../a' cannot be the name of a folder"),
        std::pair("recording = 3", "recording is written [[recording]]"),
        std::pair("recordings = [\"*/*.mcap\"]\n[merge]\nshards = 0", "shards is not between"),
        std::pair("recordings = [\"*/*.mcap\"]\n[merge]\nsame_site = 1",
                  "line 3: same_site is no true or false"),
        std::pair("recordings = [\"*/*.mcap\"]\n[deliver]\ncsr = \"a\"", "[deliver] has no csr")}) {
    EXPECT_NE(refusal(text).find(part), std::string::npos) << text << "\n" << refusal(text);
  }
}

TEST_F(FleetTest, ThePlanIsReadBackAsItWasWritten) {
  const FleetPlan plan = planned();
  const FleetPlan read = read_plan(folder / "plan");
  ASSERT_EQ(read.shards.size(), plan.shards.size());
  for (std::size_t i = 0; i < plan.shards.size(); ++i) {
    EXPECT_EQ(read.shards[i].id, plan.shards[i].id);
    EXPECT_EQ(read.shards[i].words, plan.shards[i].words);
    EXPECT_EQ(read.shards[i].number, plan.shards[i].number);
    EXPECT_EQ(read.shards[i].memory, plan.shards[i].memory);
  }
  EXPECT_EQ(read.products.size(), plan.products.size());
  EXPECT_EQ(plan.of(FleetStage::map).size(), 3U);
  EXPECT_EQ(plan.of(FleetStage::pairs).size(), 3U) << "no more than pairs";
  EXPECT_EQ(plan.shards[1].id, "map-drive-2");
}

TEST_F(FleetTest, NamesStayWhereARecordingIsAdded) {
  EXPECT_EQ(planned("recordings = [\"b/*.mcap\"]").shards.front().id, "map-drive");
  const FleetPlan plan = planned();
  EXPECT_EQ(plan.shards[0].inputs.front(), folder / "a/drive.mcap");
  EXPECT_EQ(plan.shards[0].id, "map-drive-2");
  EXPECT_EQ(plan.shards[1].id, "map-drive");
}

TEST_F(FleetTest, TheSameRecordingTwiceIsRefused) {
  folder.write("b/drive.mcap", "a/drive.mcap");
  EXPECT_THROW(planned("recordings = [\"*/drive.mcap\"]"), InputError);
}

TEST_F(FleetTest, DamagedPlansAreRefused) {
  planned();
  EXPECT_THROW(read_plan(folder / "a"), InputError);
  const std::string whole = [&] {
    std::ostringstream text;
    text << std::ifstream(folder / "plan/shards.jsonl").rdbuf();
    return text.str();
  }();
  for (std::size_t length = 1; length < whole.size() - 1; length += 97) {
    folder.write("plan/shards.jsonl", whole.substr(0, length));
    EXPECT_THROW(static_cast<void>(read_plan(folder / "plan")), InputError) << length;
  }
  folder.write("plan/plan.json", "[]");
  EXPECT_THROW(read_plan(folder / "plan"), InputError);
}

TEST_F(FleetTest, AShardWaitsForEarlierStages) {
  const FleetPlan plan = planned();
  EXPECT_EQ(run(plan, 3), kShardAgain);
  EXPECT_NE(said.find("index waits for map-drive"), std::string::npos) << said;
}

TEST_F(FleetTest, AFailureHasItsReasonAndIsNotTriedAgainByItself) {
  const FleetPlan plan = planned();
  program_does("echo it began\necho adit run: the recording is broken >&2\nexit 1\n");
  EXPECT_EQ(run(plan, 0), kShardFailed);
  EXPECT_EQ(state(plan, 0), ShardState::failed);
  EXPECT_NE(describe_fleet(plan).find("failed   map-drive: adit run: the recording is broken"),
            std::string::npos);
  EXPECT_EQ(run(plan, 0), kShardFailed);
  EXPECT_NE(said.find("has failed before"), std::string::npos);
  ShardLedger(plan.folder).forgive("map-drive");
  EXPECT_EQ(state(plan, 0), ShardState::waiting);
}

TEST_F(FleetTest, ARunWithoutAMapHasFailed) {
  const FleetPlan plan = planned();
  program_does("exit 0\n");
  EXPECT_EQ(run(plan, 0), kShardFailed);
  EXPECT_NE(said.find("its run has made no map"), std::string::npos) << said;
}

TEST_F(FleetTest, AMapIsTakenAndStays) {
  const FleetPlan plan = planned();
  program_makes_a_map();
  EXPECT_EQ(run(plan, 0), kShardDone) << said;
  EXPECT_TRUE(fs::exists(plan.folder / "maps/drive/map.adit"));
  EXPECT_EQ(read_places(plan.folder / "maps/drive/places.json").keyframes, 6U);
  program_does("exit 1\n");
  EXPECT_EQ(run(plan, 0), kShardDone);
  EXPECT_NE(said.find("kept   map-drive"), std::string::npos);
  EXPECT_EQ(ShardLedger(plan.folder).starts("map-drive").size(), 1U) << "it ran once";
  folder.write("a/drive.mcap", "another one");
  EXPECT_EQ(state(planned(), 0), ShardState::waiting) << "its recording is another one";
  EXPECT_EQ(run(plan, 0), kShardDone) << "as planned";
}

TEST_F(FleetTest, AChangedRecordingIsNoticed) {
  const FleetPlan plan = planned();
  folder.write("a/drive.mcap", "another one");
  EXPECT_EQ(run(plan, 0), kShardFailed);
  EXPECT_NE(said.find("has changed since the plan was made"), std::string::npos);
}

TEST_F(FleetTest, AKilledShardIsTriedThreeTimes) {
  const FleetPlan plan = planned();
  program_does("kill -9 $$\n");
  for (std::size_t i = 0; i < kMostKills; ++i) {
    EXPECT_EQ(run_apart(plan, 0), kShardAgain);
    EXPECT_EQ(state(plan, 0), ShardState::running) << "or killed";
  }
  EXPECT_EQ(run(plan, 0), kShardFailed);
  EXPECT_NE(said.find("it was killed 3 times"), std::string::npos);
}

TEST_F(FleetTest, AFullDiskIsNoFailure) {
  const FleetPlan plan = planned();
  program_does(
      "echo adit run: out/map.ply: cannot be written: No space left on device >&2; exit 1\n");
  EXPECT_EQ(run(plan, 0), kShardAgain);
  EXPECT_EQ(state(plan, 0), ShardState::waiting);
  program_makes_a_map();
  EXPECT_EQ(run(plan, 0), kShardDone) << said;
}

TEST_F(FleetTest, AMapThatFailsLaterIsNotTheEarlierOne) {
  const FleetPlan plan = planned();
  program_makes_a_map();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(run(plan, i), kShardDone) << said;
  }
  index_maps(plan, folder.path());
  EXPECT_NE(test::content(folder / "pairs.json").find("\"failed\":[]"), std::string::npos);
  folder.write("a/drive.mcap", "another one");
  const FleetPlan again = planned();
  program_does("exit 1\n");
  EXPECT_EQ(run(again, 0), kShardFailed);
  EXPECT_EQ(run(again, 1), kShardDone) << "the others stay";
  index_maps(again, folder.path());
  EXPECT_NE(test::content(folder / "pairs.json").find("\"failed\":[\"drive\"]"), std::string::npos)
      << test::content(folder / "pairs.json");
}

TEST_F(FleetTest, AResultThatIsGoneIsMadeAgain) {
  const FleetPlan plan = planned();
  program_makes_a_map();
  EXPECT_EQ(run(plan, 0), kShardDone);
  fs::remove_all(plan.folder / "maps/drive");
  EXPECT_EQ(state(plan, 0), ShardState::waiting);
  EXPECT_EQ(run(plan, 0), kShardDone);
  EXPECT_NE(said.find("done   map-drive"), std::string::npos) << said;
}

TEST_F(FleetTest, ARecordingThatIsGoneIsAFailureOfItAlone) {
  const FleetPlan plan = planned();
  fs::remove(folder / "a/drive.mcap");
  EXPECT_EQ(run(plan, 0), kShardFailed);
  EXPECT_EQ(state(plan, 0), ShardState::failed);
}

TEST_F(FleetTest, APlanMayBeMovedAndNamedWithASlash) {
  const FleetPlan plan = planned();
  program_makes_a_map();
  EXPECT_EQ(run(plan, 0), kShardDone);
  fs::rename(folder / "plan", folder / "moved");
  const FleetPlan moved = read_plan((folder / "moved").string() + "/");
  EXPECT_EQ(moved.folder, folder / "moved");
  EXPECT_EQ(state(moved, 0), ShardState::done);
  EXPECT_EQ(moved.of(FleetStage::index)[0].words[1], "{plan}");
}

TEST_F(FleetTest, APatternLeavesOutPlansAndRecordingsOfTheirOwn) {
  planned();
  folder.write("2026.08.01/cloud.pcd", "x");
  const Fleet fleet = read_fleet(folder.write("fleet.toml", R"(
recordings = ["*"]
[[recording]]
path = "a"
name = "first"
)"));
  std::vector<std::string> names;
  for (const FleetRecording& recording : fleet.recordings) {
    names.push_back(recording.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"first", "2026.08.01", "adit", "b"}));
}

TEST_F(FleetTest, DamagedRecordsAreAsNone) {
  const FleetPlan plan = planned();
  program_does("exit 1\n");
  EXPECT_EQ(run(plan, 0), kShardFailed);
  for (const char* const text : {"", "{", "[]", "{\"key\": 3}", "\xff\xfe"}) {
    folder.write("plan/failed/map-drive.json", text);
    folder.write("plan/starts/map-drive.jsonl", text);
    EXPECT_EQ(state(plan, 0), ShardState::waiting) << text;
  }
}

TEST_F(FleetTest, ShardsThatAreDoneScaleWhatOthersAreExpectedToTake) {
  const FleetPlan plan = planned();
  const ShardLedger ledger(plan.folder);
  ledger.prepare();
  ledger.set_done("map-drive", {.seconds = 3.0 * plan.shards[0].seconds,
                                .peak_memory = 2 * plan.shards[0].memory});
  const FleetPlan again = planned();
  for (const std::size_t map : {0U, 1U, 2U}) {
    EXPECT_NEAR(again.shards[map].seconds, 3.0 * plan.shards[map].seconds, 1e-6);
    EXPECT_NEAR(static_cast<double>(again.shards[map].memory),
                2.0 * static_cast<double>(plan.shards[map].memory), 2.0);
  }
  EXPECT_EQ(again.shards[3].seconds, plan.shards[3].seconds) << "of another stage";
}

TEST_F(FleetTest, ScriptsHaveAJobForEachStage) {
  const FleetPlan plan = planned();
  const auto scripts = slurm_scripts(plan, "/opt/adit's/bin/adit", {.at_once = 5, .cores = 3});
  ASSERT_EQ(scripts.size(), 2U);
  EXPECT_NE(scripts[0].text.find("'/opt/adit'\\''s/bin/adit' shard"), std::string::npos);
  EXPECT_NE(scripts[1].text.find("--job-name=adit-map --array=0-2%5 --cpus-per-task=3"),
            std::string::npos)
      << scripts[1].text;
  const auto parallel = parallel_scripts(plan, "adit", {});
  EXPECT_NE(parallel[0].text.find("seq 0 2 | parallel -q adit shard"), std::string::npos)
      << parallel[0].text;
}

TEST(SharedFiles, WhatAKilledProcessHasLeftGoes) {
  const test::TemporaryFolder folder;
  const fs::path killed = folder.write(".a.txt.0123456789abcdef.draft", "half");
  fs::last_write_time(killed, fs::file_time_type::clock::now() - std::chrono::hours(30));
  const fs::path running = folder.write(".a.txt.fedcba9876543210.draft", "half");
  put_text(folder / "a.txt", "whole");
  EXPECT_FALSE(fs::exists(killed));
  EXPECT_TRUE(fs::exists(running));
  folder.write("from/b/c.txt", "new");
  folder.write("to/b/old.txt", "old");
  put_copy(folder / "from", folder / "to");
  EXPECT_TRUE(fs::exists(folder / "to/b/c.txt"));
  EXPECT_FALSE(fs::exists(folder / "to/b/old.txt"));
}

TEST(MapPlaces, OnlyMapsNearEachOtherArePairs) {
  const Geodetic origin{.latitude = 48.7, .longitude = 9.2, .altitude = 30.0};
  const WorldFrame frame(origin);
  const auto line = [&](double from) {
    MapPlaces places{.keyframes = 20};
    for (int i = 0; i < 20; ++i) {
      places.places.push_back(frame.place_of({from + 10.0 * i, 0.0, 0.0}));
    }
    return places;
  };
  const std::vector<MapPlaces> maps = {line(0.0), line(150.0), line(1000.0), {.keyframes = 5}};
  const std::vector<MapPair> expected = {{0, 1}, {0, 3}, {1, 3}, {2, 3}};
  EXPECT_EQ(pairs_to_search(maps), expected) << "one without a place may be anywhere";
  MapPlaces seldom = line(0.0);
  seldom.places.resize(2);
  const std::vector<MapPlaces> gappy = {seldom, line(150.0)};
  EXPECT_TRUE(pairs_to_search(gappy).empty());
  seldom.gap = 180.0;
  const std::vector<MapPlaces> widened = {seldom, line(150.0), line(1000.0)};
  EXPECT_EQ(pairs_to_search(widened), (std::vector<MapPair>{{0, 1}}));
}

TEST(MapPlaces, FixesThatDoNotPlaceAMapSayWhereToLookForIt) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 4; ++id) {
      KeyframeRecord keyframe = test::record_of_a_point(id, session);
      const double sigma = id == 3 ? 100.0 : 3.0;
      keyframe.fixes = {{.id = id + 1,
                         .keyframe = id,
                         .stamp = keyframe.keyframe.stamp,
                         .place = {.latitude = 48.0, .longitude = 9.0 + 0.001 * double(id)},
                         .covariance = sigma * sigma * Eigen::Matrix3d::Identity()}};
      map.store(keyframe);
    }
  }
  const MapPlaces places = places_of(MapDatabase(file, MapAccess::read));
  EXPECT_EQ(places.keyframes, 4U);
  ASSERT_EQ(places.places.size(), 3U) << "one is known too roughly";
  EXPECT_NEAR(places.places[2].longitude, 9.002, 1e-9);
  EXPECT_NEAR(places.gap, 10.0, 1e-9);
}

}  // namespace
}  // namespace adit
