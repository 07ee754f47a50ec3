// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit run` with a map, and what is done with the map after it: info, check, export, optimize.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/clouds/pcd_reader.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/commands/command_info.hpp"
#include "adit/tools/commands/command_optimize.hpp"
#include "adit/tools/commands/command_recover.hpp"
#include "adit/tools/commands/command_run.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/g2o_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Ran;
using test::ran;

constexpr std::size_t kSweeps = 12;

/// The recording is mapped once for all tests; each has a copy of the map.
class MapCommands : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    data_ = new test::TemporaryFolder();
    recording_ = test::small_recording(data_->path(), kSweeps).recording;
    mapped_ = map_into(data_->path() / "out");
  }
  static void TearDownTestSuite() {
    delete data_;
    data_ = nullptr;
  }
  static Ran map_into(const fs::path& folder, std::vector<std::string> more = {}) {
    RunCommandOptions options;
    options.recording = recording_;
    options.output = folder;
    options.overwrite = true;
    options.config.overrides = {"preprocess.beam_spacing=0.03", "mapping.loops=false"};
    options.config.overrides.insert(options.config.overrides.end(), more.begin(), more.end());
    return ran(run_command, options);
  }
  static fs::path out(const char* name) { return data_->path() / "out" / name; }

  void SetUp() override { fs::copy_file(out("map.adit"), map_); }

  static inline test::TemporaryFolder* data_ = nullptr;
  static inline fs::path recording_;
  static inline Ran mapped_;
  test::TemporaryFolder folder_;
  fs::path map_ = folder_ / "map.adit";
};

TEST_F(MapCommands, ARunLeavesAMapAndBothTrajectories) {
  EXPECT_EQ(mapped_.code, 0) << mapped_.err;
  EXPECT_NE(mapped_.out.find("keyframes, "), std::string::npos) << mapped_.out;
  EXPECT_NE(mapped_.out.find("map.adit"), std::string::npos) << mapped_.out;
  EXPECT_FALSE(fs::exists(out("map.adit-wal"))) << "a clean end leaves one file";
  const Trajectory final = read_trajectory(out("trajectory.tum"));
  const Trajectory odometry = read_trajectory(out("odometry.tum"));
  ASSERT_EQ(final.poses.size(), kSweeps);
  ASSERT_EQ(odometry.poses.size(), kSweeps);
  EXPECT_EQ(read_trajectory(out("trajectory.kitti")).poses.size(), kSweeps);
  const Trajectory online = read_trajectory(out("online.tum"));
  ASSERT_EQ(online.poses.size(), kSweeps);
  EXPECT_EQ(online.poses.front().pose.matrix(), odometry.poses.front().pose.matrix())
      << "before the first edge";
  EXPECT_NE(test::content(out("online.tum")), test::content(out("trajectory.tum")));
  double largest = 0.0;
  for (std::size_t i = 0; i < kSweeps; ++i) {
    EXPECT_EQ(final.poses[i].stamp, odometry.poses[i].stamp);
    const Eigen::Isometry3d off = odometry.poses[i].pose.inverse() * final.poses[i].pose;
    largest = std::max(largest, off.translation().norm());
  }
  EXPECT_LT(largest, 0.05) << "m: without loops the map agrees with the odometry closely";
  EXPECT_GT(largest, 0.0) << "the submaps have a say";
  const nlohmann::json json = test::json_of(out("summary.json"));
  EXPECT_EQ(json.at("map").at("sweeps"), kSweeps);
  EXPECT_EQ(json.at("map").at("components"), 1);
  EXPECT_GT(json.at("map").at("keyframe_ms").at("p50"), 0.0);
}

TEST_F(MapCommands, AMapChangesNothingOfTheOdometryAndIsTheSameTwice) {
  ASSERT_EQ(map_into(folder_ / "again").code, 0);
  ASSERT_EQ(map_into(folder_ / "alone", {"mapping.enabled=false"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "alone/map.adit"));
  EXPECT_FALSE(fs::exists(folder_ / "alone/odometry.tum"));
  EXPECT_FALSE(fs::exists(folder_ / "alone/online.tum"));
  EXPECT_EQ(test::content(folder_ / "alone/trajectory.tum"), test::content(out("odometry.tum")));
  EXPECT_EQ(test::content(folder_ / "again/trajectory.tum"), test::content(out("trajectory.tum")));
  const auto dump = [](const fs::path& map) {
    return ran(export_command, ExportCommandOptions{.map = map, .dump = true}).out;
  };
  EXPECT_EQ(dump(folder_ / "again/map.adit"), dump(map_));
  EXPECT_GT(dump(map_).size(), 1000U);

  // And a run without a map takes the earlier run's away.
  ASSERT_EQ(map_into(folder_ / "again", {"mapping.enabled=false"}).code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "again/map.adit"));
}

TEST_F(MapCommands, InfoSaysWhatAMapHolds) {
  const Ran text = ran(info_command, InfoCommandOptions{.map = map_});
  EXPECT_EQ(text.code, 0) << text.err;
  for (const char* part :
       {"of 12 sweeps in 1.1 s", "upright    by ground: ", "0 loops", "session    1: recording",
        "run                complete", "recording sweeps   12"}) {
    EXPECT_NE(text.out.find(part), std::string::npos) << part << "\n" << text.out;
  }
  const Ran json = ran(info_command, InfoCommandOptions{.map = map_, .json = true});
  const auto parsed = nlohmann::json::parse(json.out);
  EXPECT_EQ(parsed.at("sweeps"), kSweeps);
  EXPECT_EQ(parsed.at("edges"), parsed.at("keyframes").get<int>() - 1);
  EXPECT_TRUE(parsed.at("sessions")[0].at("complete"));
  EXPECT_FALSE(parsed.at("sessions")[0].at("edited"));
  EXPECT_NEAR(parsed.at("length_m").get<double>(), 0.8 * (kSweeps - 1), 0.3);
}

TEST_F(MapCommands, InfoSaysWhatHasBecomeOfTheRun) {
  const auto told = [&](const char* statement) {
    SqliteDatabase(map_, SqliteDatabase::Mode::update).execute(statement);
    return ran(info_command, InfoCommandOptions{.map = map_}).out;
  };
  std::string text = told("UPDATE sessions SET complete = 0");
  EXPECT_NE(text.find("not complete: "), std::string::npos) << text;
  EXPECT_NE(text.find("map.adit-wal"), std::string::npos) << text;
  text = told("UPDATE sessions SET edited = 1");
  EXPECT_NE(text.find("not known to be complete"), std::string::npos) << text;
  text = told("UPDATE sessions SET complete = 1");
  EXPECT_NE(text.find("complete, and edited since"), std::string::npos) << text;
}

TEST_F(MapCommands, CheckFindsNothingInAWholeMapAndSaysWhereADamagedOneIs) {
  const Ran whole = ran(check_command, InfoCommandOptions{.map = map_});
  EXPECT_EQ(whole.code, 0) << whole.out << whole.err;
  EXPECT_NE(whole.out.find("is whole"), std::string::npos);
  {
    std::fstream file(map_, std::ios::in | std::ios::out | std::ios::binary);
    const auto size = static_cast<std::streamoff>(fs::file_size(map_));
    for (std::streamoff at = size / 2; at < size - size / 8; ++at) {
      file.seekp(at).put('\x5a');
    }
  }
  const Ran damaged = ran(check_command, InfoCommandOptions{.map = map_});
  EXPECT_EQ(damaged.code, 1);
  EXPECT_NE(damaged.out.find("is damaged"), std::string::npos) << damaged.out << damaged.err;
  const Ran json = ran(check_command, InfoCommandOptions{.map = map_, .json = true});
  EXPECT_FALSE(nlohmann::json::parse(json.out).at("whole").get<bool>());
  // What cannot be completed does not take the place of what was there.
  const fs::path cloud = folder_.write("cloud.ply", "an earlier one");
  const Ran failed =
      ran(export_command, ExportCommandOptions{.map = map_, .output = cloud, .cloud = "ply"});
  EXPECT_EQ(failed.code, 1) << failed.out;
  EXPECT_NE(failed.err.find("adit "), std::string::npos);
  EXPECT_EQ(test::content(cloud), "an earlier one");
  EXPECT_FALSE(fs::exists(folder_ / "cloud.ply.part"));
}

TEST_F(MapCommands, RecoverSavesWhatIsWhole) {
  const auto recover = [&](const char* name) {
    return ran(recover_command, RecoverCommandOptions{.map = map_, .output = folder_ / name});
  };
  const auto dump = [](const fs::path& map) {
    return ran(export_command, ExportCommandOptions{.map = map, .dump = true}).out;
  };
  const Ran whole = recover("whole.adit");
  EXPECT_EQ(whole.code, 0) << whole.out << whole.err;
  EXPECT_EQ(dump(folder_ / "whole.adit"), dump(map_)) << "nothing was damaged";
  EXPECT_EQ(recover("whole.adit").code, 2) << "it does not write over what is there";

  const std::size_t before = MapDatabase(map_, MapAccess::read).keyframes().size();
  const std::string bytes = test::content(map_);
  std::size_t damages = 0;
  // A page after the other, but for the first, which says what the file is.
  for (std::size_t page = 1; page < bytes.size() / 4096; page += 3) {
    std::string damaged = bytes;
    std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(4096 * page), 4096, '\x5a');
    folder_.write("map.adit", damaged);
    const std::string name = "recovered_" + std::to_string(page) + ".adit";
    const Ran ran_it = recover(name.c_str());
    if (ran_it.code == 1 && !fs::exists(folder_ / name)) {
      EXPECT_FALSE(ran_it.err.empty());
      continue;
    }
    const MapDatabase map(folder_ / name, MapAccess::read);
    EXPECT_TRUE(map.check().empty());
    EXPECT_LE(map.keyframes().size(), before);
    damages += ran_it.code == 1 ? 1U : 0U;
    if (ran_it.code == 0) {
      EXPECT_EQ(map.keyframes().size(), before) << "page " << page << "\n" << ran_it.out;
    }
  }
  EXPECT_GT(damages, 5U);
}

TEST_F(MapCommands, ExportWritesWhatOtherProgramsRead) {
  const auto exported = [&](ExportCommandOptions options, const char* name) {
    options.map = map_;
    options.output = folder_ / name;
    const Ran ran_it = ran(export_command, options);
    EXPECT_EQ(ran_it.code, 0) << ran_it.err;
    EXPECT_NE(ran_it.out.find(name), std::string::npos) << ran_it.out;
    return folder_ / name;
  };
  EXPECT_EQ(test::content(exported({.trajectory = "tum"}, "t.tum")),
            test::content(out("trajectory.tum")));
  EXPECT_EQ(test::content(exported({.trajectory = "kitti"}, "t.kitti")),
            test::content(out("trajectory.kitti")));
  EXPECT_EQ(test::lines(exported({.trajectory = "csv"}, "t.csv")), kSweeps + 1);
  const PoseGraph graph = read_g2o(exported({.graph = "g2o"}, "g.g2o")).graph;
  EXPECT_EQ(graph.edges().size() + 1, graph.nodes().size());
  const auto ply = read_ply(exported({.cloud = "ply"}, "c.ply")).sweep.points;
  const auto pcd = read_pcd(exported({.cloud = "pcd"}, "c.pcd")).sweep.points;
  ASSERT_EQ(ply.size(), pcd.size());
  EXPECT_GT(ply.size(), 5000U);
  EXPECT_EQ(ply.back().x, pcd.back().x);
  const auto thin =
      read_ply(exported({.cloud = "ply", .resolution = 1.0}, "thin.ply")).sweep.points.size();
  EXPECT_LT(thin, ply.size() / 2);
  EXPECT_GT(thin, 300U);
  const std::string picture = test::content(exported({.picture = true}, "map.svg"));
  EXPECT_NE(picture.find(">keyframe<"), std::string::npos);
  EXPECT_EQ(picture.find(">loop<"), std::string::npos) << "it has none";
  for (const char* format : {"ply", "pcd"}) {
    const fs::path dense = exported({.dense = format}, format);
    const auto sweep = (format == std::string("ply") ? read_ply(dense) : read_pcd(dense)).sweep;
    EXPECT_GT(sweep.points.size(), 2 * ply.size()) << "nothing is thinned";
    EXPECT_EQ(sweep.rings.size(), sweep.points.size());
    EXPECT_EQ(sweep.times.size(), sweep.points.size());
  }
  exported({.dump = true}, "dump.txt");
  EXPECT_EQ(test::content(folder_ / "dump.txt"),
            ran(export_command, ExportCommandOptions{.map = map_, .dump = true}).out);
}

TEST_F(MapCommands, ExportSaysWhatIsMissing) {
  const auto says = [&](ExportCommandOptions options, const char* what) {
    options.map = map_;
    const Ran wrong = ran(export_command, options);
    EXPECT_EQ(wrong.code, 2);
    EXPECT_NE(wrong.err.find(what), std::string::npos) << wrong.err;
  };
  says({}, "one of --trajectory");
  says({.trajectory = "tum", .graph = "g2o"}, "one of --trajectory");
  says({.trajectory = "tum"}, "-o FILE");
  says({.output = map_, .graph = "g2o"}, "cannot be written over");
  says({.output = folder_ / "x", .graph = "g2o", .recording = recording_}, "needs --dense");
  says({.output = folder_ / "x.jpg", .picture = true}, "name it *.svg or *.png");
  says({.output = folder_ / "x", .graph = "g2o", .resolution = 1.0}, "needs --cloud");
  says({.output = folder_ / "x", .cloud = "ply", .resolution = 0.0}, "between 0.001");
}

TEST_F(MapCommands, ADenseCloudIsMadeOfTheRecordingThatTheMapIsOf) {
  ExportCommandOptions options{.map = map_, .output = folder_ / "dense.ply", .dense = "ply"};
  ASSERT_EQ(ran(export_command, options).code, 0);
  const std::string cloud = test::content(*options.output);

  options.recording = folder_ / "moved";
  options.output = folder_ / "moved.ply";
  fs::copy(recording_, *options.recording, fs::copy_options::recursive);
  ASSERT_EQ(ran(export_command, options).code, 0);
  EXPECT_EQ(test::content(*options.output), cloud);

  std::ofstream times(*options.recording / "times.txt");
  for (std::size_t i = 0; i < kSweeps; ++i) {
    times << 100.0 + static_cast<double>(i) << "\n";
  }
  times.close();
  options.output = folder_ / "other.ply";
  const Ran other = ran(export_command, options);
  EXPECT_EQ(other.code, 1);
  EXPECT_NE(other.err.find("none of its sweeps is in the map"), std::string::npos) << other.err;
  EXPECT_FALSE(fs::exists(*options.output));
}

TEST_F(MapCommands, ADenseCloudOfAnotherFileWithTheSameStampsSaysSo) {
  const fs::path copy = folder_ / "copy";
  fs::copy(recording_, copy, fs::copy_options::recursive);
  RunCommandOptions run;
  run.recording = copy;
  run.output = folder_ / "out";
  run.config.overrides = {"preprocess.beam_spacing=0.03", "mapping.loops=false"};
  ASSERT_EQ(ran(run_command, run).code, 0);
  fs::path sweep;
  for (const auto& file : fs::recursive_directory_iterator(copy)) {
    sweep = file.path().extension() == ".bin" ? file.path() : sweep;
  }
  std::string bytes = test::content(sweep);
  bytes[100] = static_cast<char>(bytes[100] ^ 1);
  std::ofstream(sweep, std::ios::binary) << bytes;
  ExportCommandOptions options{
      .map = folder_ / "out/map.adit", .output = folder_ / "d.ply", .dense = "ply"};
  const Ran silent = ran(export_command, options);
  EXPECT_EQ(silent.code, 1);
  EXPECT_NE(silent.err.find("not what the map was made of any more"), std::string::npos)
      << silent.err;
  options.recording = copy;
  const Ran named = ran(export_command, options);
  EXPECT_EQ(named.code, 0) << named.err;
  EXPECT_NE(named.out.find("of another file than the map"), std::string::npos) << named.out;

  RunCommandOptions again;
  again.output = folder_ / "again";
  again.from = folder_ / "out/map.adit";
  const Ran from = ran(run_command, again);
  EXPECT_EQ(from.code, 1);
  EXPECT_NE(from.err.find("by its content"), std::string::npos) << from.err;
}

TEST_F(MapCommands, ExportDoesNotWriteOverTheRecording) {
  const fs::path sweep = folder_.write("one.mcap", "a recording");
  const Ran over =
      ran(export_command,
          ExportCommandOptions{.map = map_, .output = sweep, .dense = "ply", .recording = sweep});
  EXPECT_EQ(over.code, 2);
  EXPECT_NE(over.err.find("cannot be written over"), std::string::npos) << over.err;
  EXPECT_EQ(test::content(sweep), "a recording");
}

TEST_F(MapCommands, PartsOfAMapStayApartWhereItsRunDidNotEnd) {
  {
    const SqliteDatabase raw(map_, SqliteDatabase::Mode::update);
    raw.execute("UPDATE sessions SET ending = 0, complete = 0");
    raw.execute("DELETE FROM edges WHERE node_from = 1");
  }
  const fs::path file = folder_ / "parts.tum";
  const Ran done =
      ran(export_command, ExportCommandOptions{.map = map_, .output = file, .trajectory = "tum"});
  ASSERT_EQ(done.code, 0) << done.err;
  const std::string text = test::content(file);
  EXPECT_EQ(std::ranges::count(text, '#'), 1) << text;
}

TEST_F(MapCommands, OptimizePutsDisturbedPosesBackIntoTheMap) {
  const auto poses = [&] { return MapDatabase(map_, MapAccess::read).keyframes(); };
  const auto before = poses();
  {
    MapDatabase map(map_, MapAccess::write);
    PoseNode moved{.id = before[3].id, .T_map_node = before[3].T_map_keyframe};
    moved.T_map_node.translation().y() += 0.7;
    map.revise({.poses = {moved}});
  }
  const Ran other =
      ran(optimize_command, OptimizeCommandOptions{.input = map_, .output = folder_ / "o.g2o"});
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_GT(
      (poses()[3].T_map_keyframe.translation() - before[3].T_map_keyframe.translation()).norm(),
      0.6)
      << "with -o the map stays as it is";
  const Ran done = ran(optimize_command, OptimizeCommandOptions{.input = map_});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.out.find("wrote        the poses of "), std::string::npos) << done.out;
  const auto after = poses();
  const std::string dump = test::dump_of(MapDatabase(map_, MapAccess::read));
  const Ran again = ran(optimize_command, OptimizeCommandOptions{.input = map_});
  EXPECT_NE(again.out.find("wrote        nothing"), std::string::npos) << again.out;
  EXPECT_EQ(test::dump_of(MapDatabase(map_, MapAccess::read)), dump);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT(
        (after[i].T_map_keyframe.translation() - before[i].T_map_keyframe.translation()).norm(),
        1e-6);
  }
}

/// Every command on a file that is no good.
std::vector<Ran> all_of(const fs::path& map, const fs::path& output) {
  return {
      ran(info_command, InfoCommandOptions{.map = map}),
      ran(check_command, InfoCommandOptions{.map = map}),
      ran(export_command, ExportCommandOptions{.map = map, .output = output, .trajectory = "tum"}),
      ran(optimize_command, OptimizeCommandOptions{.input = map})};
}

TEST_F(MapCommands, WhatIsNoMapIsSaidToBeNone) {
  const auto expect = [&](const fs::path& map, const char* what) {
    for (const Ran& wrong : all_of(map, folder_ / "t.tum")) {
      EXPECT_EQ(wrong.code, 1);
      EXPECT_NE(wrong.err.find(what), std::string::npos) << wrong.err;
      EXPECT_NE(wrong.err.find(map.filename().string()), std::string::npos) << wrong.err;
    }
    EXPECT_FALSE(fs::exists(folder_ / "t.tum"));
  };
  expect(folder_ / "none.adit", "there is no such file");
  fs::create_symlink("turn.adit", folder_ / "turn.adit");
  const Ran info = ran(info_command, InfoCommandOptions{.map = folder_ / "turn.adit"});
  EXPECT_NE(info.err.find("cannot be looked at: Too many"), std::string::npos) << info.err;
  expect(folder_.write("text.adit", std::string(5000, 'x')), "not a database");
  SqliteDatabase(map_, SqliteDatabase::Mode::update).execute("PRAGMA user_version = 11");
  expect(map_, "written by a newer adit");
}

TEST_F(MapCommands, AMapThatIsBeingWrittenIsReadButNotWritten) {
  MapDatabase writer(map_, MapAccess::write);
  PoseNode moved{.id = 3, .T_map_node = Eigen::Isometry3d::Identity()};
  moved.T_map_node.translation().y() = 0.7;
  writer.revise({.poses = {moved}});
  EXPECT_EQ(ran(info_command, InfoCommandOptions{.map = map_}).code, 0);
  EXPECT_EQ(ran(check_command, InfoCommandOptions{.map = map_}).code, 0);
  const Ran locked = ran(optimize_command, OptimizeCommandOptions{.input = map_});
  EXPECT_EQ(locked.code, 1);
  EXPECT_NE(locked.err.find("is being written by process"), std::string::npos) << locked.err;
}

TEST_F(MapCommands, ARunDoesNotTouchAMapThatAnotherWrites) {
  ASSERT_EQ(map_into(folder_ / "out").code, 0);
  const std::string before = test::content(folder_ / "out/trajectory.tum");
  const MapDatabase writer(folder_ / "out/map.adit", MapAccess::write);
  const Ran second = map_into(folder_ / "out");
  EXPECT_EQ(second.code, 1);
  EXPECT_NE(second.err.find("is being written by process"), std::string::npos) << second.err;
  EXPECT_EQ(test::content(folder_ / "out/trajectory.tum"), before);
}

TEST_F(MapCommands, AnEmptyMapIsOneToo) {
  const fs::path empty = folder_ / "empty.adit";
  { const MapDatabase map(empty, MapAccess::write); }
  const Ran info = ran(info_command, InfoCommandOptions{.map = empty});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_NE(info.out.find("keyframes  none"), std::string::npos) << info.out;
  EXPECT_EQ(ran(check_command, InfoCommandOptions{.map = empty}).code, 0);
  const Ran cloud =
      ran(export_command,
          ExportCommandOptions{.map = empty, .output = folder_ / "c.ply", .cloud = "ply"});
  EXPECT_EQ(cloud.code, 0) << cloud.err;
  EXPECT_NE(cloud.out.find("0 points"), std::string::npos);
}

}  // namespace
}  // namespace adit
