// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/map_database.hpp"

#include <algorithm>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/error_text.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::dump_of;
using test::record;

TEST(MapDatabase, HoldsWhatWasStored) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  std::string written;
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 20; ++id) {
      map.store(record(id, session));
    }
    map.revise({.statuses = {{3, EdgeStatus::revoked}}});
    written = dump_of(map);
  }
  EXPECT_FALSE(fs::exists(file.string() + "-wal")) << "a clean end leaves one file";
  EXPECT_FALSE(fs::exists(file.string() + ".lock"));
  const MapDatabase map(file, MapAccess::read);
  EXPECT_EQ(dump_of(map), written);
  EXPECT_TRUE(map.check().empty());
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  ASSERT_EQ(keyframes.size(), 20U);
  const KeyframeRecord expected = record(7, 1);
  EXPECT_EQ(keyframes[7].T_map_keyframe.matrix(), expected.keyframe.T_map_keyframe.matrix());
  EXPECT_EQ(keyframes[7].covariance, expected.keyframe.covariance);
  EXPECT_EQ(keyframes[7].stamp, expected.keyframe.stamp);
  EXPECT_EQ(map.submap(7).chunks, expected.submap.chunks);
  EXPECT_EQ(map.graph().edges()[3].status, EdgeStatus::revoked);
  EXPECT_EQ(map.graph().edges()[4].information, record(5, 1).edges[0].information);
  EXPECT_EQ(map.sessions()[0].provenance, (std::vector<std::pair<std::string, std::string>>{
                                              {"device", "llvmpipe"}, {"input", "abc123"}}));
}

TEST(MapDatabase, StoresARecordAsAWholeOrNotAtAll) {
  const test::TemporaryFolder folder;
  MapDatabase map(folder / "map.adit", MapAccess::write);
  const SessionId session = test::add_session(map);
  map.store(record(0, session));
  const std::string before = dump_of(map);
  KeyframeRecord wrong = record(1, session);
  wrong.edges.front().from = 99;  // no such keyframe
  EXPECT_NE(test::error_of<FileError>([&] { map.store(wrong); }).find("FOREIGN KEY"),
            std::string::npos);
  EXPECT_EQ(dump_of(map), before);
  map.store(record(1, session));
  EXPECT_NE(test::error_of<FileError>([&] { map.store(record(1, session)); }).find("UNIQUE"),
            std::string::npos);
}

TEST(MapDatabase, FindsSubmapsByPlaceAlsoWhereThatHasChanged) {
  const test::TemporaryFolder folder;
  MapDatabase map(folder / "map.adit", MapAccess::write);
  const SessionId session = test::add_session(map);
  for (NodeId id = 0; id < 50; ++id) {
    map.store(record(id, session));  // along x, 10 m apart, each reaching 4 m
  }
  const auto near = [&](double x) {
    return map.submaps_within({x - 1.0, -1.0, -1.0}, {x + 1.0, 1.0, 1.0});
  };
  EXPECT_EQ(near(100.0), std::vector<NodeId>{10});
  EXPECT_EQ(near(105.0), (std::vector<NodeId>{10, 11}));
  EXPECT_TRUE(near(-20.0).empty());
  std::vector<PoseNode> moved = {
      {.id = 10, .T_map_node = record(10, session).keyframe.T_map_keyframe}};
  moved[0].T_map_node.translation().x() = -20.0;
  map.revise({.poses = moved});
  EXPECT_TRUE(near(100.0).empty());
  EXPECT_EQ(near(-20.0), std::vector<NodeId>{10});
  EXPECT_EQ(map.keyframes()[10].T_map_keyframe.translation().x(), -20.0);
}

TEST(MapDatabase, CandidatesAreReplacedById) {
  const test::TemporaryFolder folder;
  MapDatabase map(folder / "map.adit", MapAccess::write);
  const SessionId session = test::add_session(map);
  map.store(record(0, session));
  map.store(record(1, session));
  LoopCandidate candidate{.from = 1, .to = 0, .overlap = 0.5, .reason = "waits"};
  map.revise({.candidates = {candidate}});
  candidate = map.candidates().at(0);
  EXPECT_EQ(candidate.reason, "waits");
  candidate.verdict = CandidateVerdict::accepted;
  candidate.reason = "three agree";
  PoseEdge edge = record(1, session).edges.front();
  edge.kind = EdgeKind::loop;
  map.revise({.edges = {edge}, .candidates = {candidate}});
  ASSERT_EQ(map.candidates().size(), 1U);
  EXPECT_EQ(map.candidates()[0].verdict, CandidateVerdict::accepted);
  EXPECT_EQ(map.graph().edges().back().kind, EdgeKind::loop);
}

TEST(MapDatabase, KeepsFixesVerticalsAndThePlaceInTheWorld) {
  const test::TemporaryFolder folder;
  MapDatabase map(folder / "map.adit", MapAccess::write);
  const SessionId session = test::add_session(map);
  KeyframeRecord first = record(0, session);
  first.keyframe.vertical = Vertical::gravity;
  MapFix fix{.id = 1,
             .keyframe = 0,
             .stamp = Nanoseconds(17),
             .kind = GnssFixKind::satellite_augmented,
             .place = {48.000000001, 11.1, 500.25},
             .covariance = Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal().toDenseMatrix(),
             .p_keyframe_antenna = {0.1, 0.2, 0.3},
             .path = 12.5};
  first.fixes = {fix};
  map.store(first);
  EXPECT_EQ(map.graph().levels().size(), 1U);
  EXPECT_TRUE(map.graph().fixes().empty());
  EXPECT_FALSE(map.georeference());

  fix.verdict = FixVerdict::used;
  fix.chi2 = 0.5;
  fix.information = Eigen::Matrix3d::Identity();
  fix.information(0, 1) = fix.information(1, 0) = 0.25;
  const Georeference world{.origin = {48.0, 11.1, 500.0},
                           .T_world_map = test::step(3.0, 0.5),
                           .covariance = 2.0 * Matrix6d::Identity()};
  map.revise({.fixes = {fix}, .georeference = world});
  ASSERT_EQ(map.fixes().size(), 1U);
  const MapFix back = map.fixes().front();
  EXPECT_EQ(back.verdict, FixVerdict::used);
  EXPECT_EQ(back.kind, fix.kind);
  EXPECT_EQ(back.stamp, fix.stamp);
  EXPECT_EQ(back.place.latitude, fix.place.latitude);
  EXPECT_EQ(back.covariance, fix.covariance);
  EXPECT_EQ(back.information, fix.information);
  EXPECT_EQ(back.p_keyframe_antenna, fix.p_keyframe_antenna);
  EXPECT_EQ(back.path, fix.path);
  ASSERT_TRUE(map.georeference());
  EXPECT_EQ(map.georeference()->T_world_map.matrix(), world.T_world_map.matrix());
  EXPECT_EQ(map.georeference()->covariance, world.covariance);
  const PoseGraph graph = map.graph();
  ASSERT_EQ(graph.fixes().size(), 1U);
  EXPECT_NEAR(graph.fixes()[0].p_world.y(), 1.11e-4, 1e-5);
  EXPECT_EQ(graph.T_world_map().matrix(), world.T_world_map.matrix());
  EXPECT_TRUE(map.check().empty());
}

TEST(MapDatabase, KeepsHeadingsForItsGraph) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    map.store(record(0, session));
    const MapHeading heading{.keyframe = 0,
                             .stamp = Nanoseconds(17),
                             .yaw = 0.75,
                             .sigma = 0.02,
                             .axis_keyframe = {0.0, 1.0, 0.0},
                             .information = 1234.5};
    map.revise({.headings = std::vector{heading, heading}});
    map.revise({.headings = std::vector{heading}});
    EXPECT_TRUE(map.graph().headings().empty()) << "the map has no place in the world";
    map.revise({.georeference = Georeference{.origin = {48.0, 11.1, 500.0}}});
  }
  const MapDatabase map(file, MapAccess::read);
  ASSERT_EQ(map.headings().size(), 1U) << "the later ones have replaced the others";
  const MapHeading back = map.headings().front();
  EXPECT_EQ(back.stamp, Nanoseconds(17));
  EXPECT_EQ(back.yaw, 0.75);
  EXPECT_EQ(back.sigma, 0.02);
  EXPECT_EQ(back.axis_keyframe, Eigen::Vector3d::UnitY());
  ASSERT_EQ(map.graph().headings().size(), 1U);
  EXPECT_EQ(map.graph().headings()[0].information, 1234.5);
  EXPECT_NEAR(map.graph().headings()[0].yaw, 0.75, 1e-6);
  EXPECT_TRUE(map.check().empty());
}

TEST(MapDatabase, AMapOfTheOlderSchemaIsReadAndItsFirstWriterBringsItToThisOne) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    map.store(record(0, session));
    map.store(record(1, session));
    map.revise({.candidates = {{.from = 0, .to = 1, .overlap = 0.5, .reason = "waits"}}});
  }
  test::make_schema_8(file);
  {
    const SqliteDatabase raw(file, SqliteDatabase::Mode::update);
    for (const char* column : {"rms", "correction", "turn", "through", "figure", "source"}) {
      raw.execute(std::string("ALTER TABLE candidates DROP COLUMN ") + column);
    }
    for (const char* column : {"steps", "ending", "complete", "edited"}) {
      raw.execute(std::string("ALTER TABLE sessions DROP COLUMN ") + column);
    }
    raw.execute("ALTER TABLE keyframes DROP COLUMN vertical");
    for (const char* table :
         {"end_keyframes", "end_edges", "end_candidates", "fixes", "georeference", "end_fixes",
          "end_georeference", "control", "anchors"}) {
      raw.execute(std::string("DROP TABLE ") + table);
    }
    raw.execute("PRAGMA user_version = 1");
  }
  const std::string before = test::dump_of(MapDatabase(file, MapAccess::read));
  EXPECT_EQ(MapDatabase(file, MapAccess::read).candidates().at(0).overlap, 0.5);
  {
    MapDatabase map(file, MapAccess::write);
    EXPECT_EQ(test::dump_of(map), before) << "nothing else has changed";
    LoopCandidate candidate = map.candidates().at(0);
    candidate.rms = 0.25;
    candidate.verdict = CandidateVerdict::revoked;
    map.revise({.candidates = {candidate}});
  }
  const MapDatabase map(file, MapAccess::read);
  EXPECT_TRUE(map.progress(1).edited) << "nobody knows how far its run came";
  EXPECT_EQ(map.candidates().at(0).rms, 0.25);
  EXPECT_EQ(map.candidates().at(0).verdict, CandidateVerdict::revoked);
  EXPECT_TRUE(map.check().empty());
}

TEST(MapDatabase, ReadersSeeWhatIsStoredWhileOneWrites) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  MapDatabase map(file, MapAccess::write);
  const SessionId session = test::add_session(map);
  map.store(record(0, session));
  const MapDatabase first(file, MapAccess::read);
  const MapDatabase second(file, MapAccess::read);
  EXPECT_EQ(first.keyframes().size(), 1U);
  map.store(record(1, session));
  EXPECT_EQ(first.keyframes().size(), 2U);
  EXPECT_EQ(dump_of(second), dump_of(map));
  EXPECT_NE(test::error_of<FileError>([&] {
              MapDatabase other(file, MapAccess::read);
              other.revise({.statuses = {{0, EdgeStatus::revoked}}});
            }).find("readonly"),
            std::string::npos);
}

TEST(MapDatabase, SaysWhatAFileIsThatIsNoMap) {
  const test::TemporaryFolder folder;
  EXPECT_NE(test::error_of<FileError>([&] {
              MapDatabase map(folder / "none.adit", MapAccess::read);
            }).find("there is no such file"),
            std::string::npos);
  const fs::path text = folder.write("text.adit", std::string(5000, 'x'));
  EXPECT_NE(test::error_of<FileError>([&] {
              MapDatabase map(text, MapAccess::read);
            }).find("not a database"),
            std::string::npos);
  EXPECT_NE(test::error_of<FileError>([&] {
              MapDatabase map(text, MapAccess::write);
            }).find("not a database"),
            std::string::npos);
  const fs::path other = folder / "other.adit";
  SqliteDatabase(other, SqliteDatabase::Mode::create).execute("CREATE TABLE t(a)");
  EXPECT_NE(test::error_of<FileError>([&] {
              MapDatabase map(other, MapAccess::read);
            }).find("but no map"),
            std::string::npos);
  EXPECT_NE(test::error_of<FileError>([&] {
              MapDatabase map(other, MapAccess::write);
            }).find("but no map"),
            std::string::npos);
  EXPECT_NE(test::error_of<FileError>([&] {
              MapDatabase map(folder / "no/map.adit", MapAccess::write);
            }).find("No such file or directory"),
            std::string::npos);
}

TEST(MapDatabase, AnAnchorMovesASessionWithAllThatIsInIt) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  MapDatabase map(file, MapAccess::write);
  const SessionId first = test::add_session(map);
  const SessionId second = test::add_session(map);
  map.store(test::record(0, first));
  KeyframeRecord other = test::record(1, second);
  other.edges.clear();
  map.store(other);
  EXPECT_TRUE(map.anchors().empty());
  const Eigen::Isometry3d anchor = test::step(500.0, 0.5 * std::numbers::pi);
  map.set_anchor(second, anchor);
  const auto pose = [&](NodeId id) { return map.keyframe(id)->T_map_keyframe; };
  EXPECT_TRUE(pose(0).isApprox(test::step(0.0)));
  EXPECT_TRUE(pose(1).isApprox(anchor * test::step(10.0)));
  EXPECT_TRUE(map.graph().nodes()[1].T_map_node.isApprox(pose(1)));
  const auto within = [&](double x, double y) {
    return map.submaps_within({x - 1.0, y - 1.0, -1.0}, {x + 1.0, y + 1.0, 1.0});
  };
  EXPECT_EQ(within(500.0, 10.0), std::vector<NodeId>{1});
  EXPECT_EQ(within(10.0, 0.0), std::vector<NodeId>{}) << "it was there";
  // What is written is of the map's frame, too, and stays within the session when that moves.
  map.revise({.poses = {{.id = 1, .T_map_node = anchor * test::step(12.0)}}});
  EXPECT_TRUE(pose(1).isApprox(anchor * test::step(12.0)));
  map.set_anchor(second, Eigen::Isometry3d::Identity());
  EXPECT_TRUE(pose(1).isApprox(test::step(12.0), 1e-9));
  EXPECT_TRUE(map.check().empty());
}

TEST(MapDatabase, AFileWhoseRunWasStoppedBeforeItHadBegunIsToldAndCanBeBegun) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  { SqliteDatabase(file, SqliteDatabase::Mode::update).execute("PRAGMA journal_mode = WAL"); }
  EXPECT_NE(test::error_of<FileError>([&] {
              MapDatabase map(file, MapAccess::read);
            }).find("stopped before it had begun"),
            std::string::npos);
  MapDatabase map(file, MapAccess::write);
  EXPECT_EQ(test::add_session(map), 1);
  EXPECT_TRUE(map.check().empty());
}

TEST(MapDatabase, RefusesANewerSchemaAndLeavesItAsItIs) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  { MapDatabase map(file, MapAccess::write); }
  {
    const SqliteDatabase raw(file, SqliteDatabase::Mode::update);
    raw.execute("PRAGMA user_version = 11");
  }
  for (const MapAccess access : {MapAccess::read, MapAccess::write}) {
    const std::string error = test::error_of<FileError>([&] { MapDatabase map(file, access); });
    EXPECT_NE(error.find("its schema is 11, this one knows up to 10"), std::string::npos) << error;
  }
}

TEST(MapDatabase, CheckNamesWhatIsDamaged) {
  const test::TemporaryFolder folder;
  const fs::path file = folder / "map.adit";
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 5; ++id) {
      map.store(record(id, session));
    }
  }
  {
    const SqliteDatabase raw(file, SqliteDatabase::Mode::update);
    raw.execute("UPDATE chunks SET zstd = x'28b52ffd0000' WHERE keyframe = 1 AND number = 2");
    raw.execute("DELETE FROM chunks WHERE keyframe = 2 AND number = 1");
    raw.execute("UPDATE edges SET node_to = 77 WHERE id = 1");
    raw.execute("DELETE FROM places WHERE keyframe = 4");
  }
  const MapDatabase map(file, MapAccess::read);
  const std::vector<std::string> problems = map.check();
  const auto told = [&](const std::string& words) {
    return std::ranges::any_of(problems, [&](const std::string& problem) {
      return problem.find(words) != std::string::npos;
    });
  };
  EXPECT_TRUE(told("chunks of keyframes 1: not as they were written"));
  EXPECT_TRUE(told("submap 2 has 2 of 3 chunks"));
  EXPECT_TRUE(told("a row of the table edges refers to one of keyframes that is missing"));
  EXPECT_TRUE(told("edges 1: not as they were written"));
  EXPECT_TRUE(told("submap 4 is missing from the index of places"));
  EXPECT_EQ(map.keyframes().size(), 5U) << "the rest can be read";
  EXPECT_EQ(map.submap(3).chunks.size(), 3U);
}

}  // namespace
}  // namespace adit
