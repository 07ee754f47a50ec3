// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit split` of a map of two sessions.
#include "adit/tools/commands/command_split.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/ran.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::Ran;

class CommandSplit : public testing::Test {
 protected:
  CommandSplit() {
    MapDatabase store(folder_ / "both.adit", MapAccess::write);
    for (const char* const name : {"monday", "tuesday"}) {
      const SessionId session = store.add_session({.name = name});
      const NodeId first = static_cast<NodeId>(store.keyframes().size());
      for (NodeId id = first; id < first + 3; ++id) {
        KeyframeRecord record = test::record_of_a_point(id, session);
        record.keyframe.T_map_keyframe = at(id);
        record.edges.clear();
        if (id > first) {
          record.edges.push_back(edge(id - 1, id, EdgeKind::odometry));
        }
        record.candidates.clear();
        record.fixes = {{.id = id + 1, .keyframe = id, .place = kOrigin}};
        store.store(record);
      }
      store.set_complete(session);
    }
    store.revise({.edges = {edge(1, 4, EdgeKind::loop), edge(3, 5, EdgeKind::loop)},
                  .candidates = {{.id = 7, .from = 1, .to = 4, .reason = {}},
                                 {.id = 8, .from = 3, .to = 5, .reason = {}}},
                  .georeference = Georeference{.origin = kOrigin},
                  .control = std::vector<ControlPoint>{{.name = "A", .keyframe = 0, .place = {}},
                                                       {.name = "B", .keyframe = 4, .place = {}}}});
  }

  static Eigen::Isometry3d at(NodeId id) {
    return Eigen::Isometry3d(Eigen::Translation3d(2.0 * static_cast<double>(id), 0.5, 0.0));
  }
  static PoseEdge edge(NodeId from, NodeId to, EdgeKind kind) {
    return {.from = from, .to = to, .T_from_to = at(from).inverse() * at(to), .kind = kind};
  }
  Ran split(const std::vector<int64_t>& sessions, const std::string& to) const {
    return test::ran(split_command, SplitCommandOptions{.map = folder_ / "both.adit",
                                                        .sessions = sessions,
                                                        .output = folder_ / to,
                                                        .json = true});
  }

  static constexpr Geodetic kOrigin{.latitude = 48.0, .longitude = 11.0, .altitude = 500.0};
  test::TemporaryFolder folder_;
};

TEST_F(CommandSplit, ASessionKeepsWhatIsItsOwnAndNothingOfTheOther) {
  const MapDatabase both(folder_ / "both.adit", MapAccess::read);
  const std::string before = test::dump_of(both);
  const Ran ran = split({2}, "tuesday.adit");
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(test::dump_of(both), before);
  const MapDatabase map(folder_ / "tuesday.adit", MapAccess::read);
  EXPECT_TRUE(map.check().empty());
  ASSERT_EQ(map.sessions().size(), 1U);
  EXPECT_EQ(map.sessions()[0].name, "tuesday");
  EXPECT_TRUE(map.progress(1).complete);
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  ASSERT_EQ(keyframes.size(), 3U);
  for (NodeId id = 3; id < 6; ++id) {
    EXPECT_EQ(keyframes[static_cast<std::size_t>(id - 3)].id, id);
    EXPECT_EQ(keyframes[static_cast<std::size_t>(id - 3)].T_map_keyframe.matrix(), at(id).matrix());
    EXPECT_EQ(map.submap(id).chunks, both.submap(id).chunks);
  }
  EXPECT_EQ(map.graph().edges().size(), 3U) << "two of the odometry, one loop";
  ASSERT_EQ(map.candidates().size(), 1U);
  EXPECT_EQ(map.candidates()[0].id, 8);
  EXPECT_EQ(map.fixes().size(), 3U);
  ASSERT_EQ(map.control_points().size(), 1U);
  EXPECT_EQ(map.control_points()[0].name, "B");
  EXPECT_TRUE(map.georeference().has_value());
  const auto report = nlohmann::json::parse(ran.out);
  EXPECT_EQ(report.at("schema"), "split/1");
  EXPECT_EQ(report.at("odometry_edges"), 2);
  EXPECT_EQ(report.at("loops"), 1);
  EXPECT_EQ(report.at("components"), 1);
}

TEST_F(CommandSplit, WhatCannotBeSplitIsRefusedAndNothingIsWritten) {
  EXPECT_EQ(split({3}, "out.adit").code, 2);
  EXPECT_NE(split({3}, "out.adit").err.find("has the sessions 1, 2"), std::string::npos);
  EXPECT_EQ(split({1, 2, 1}, "out.adit").code, 2);
  EXPECT_EQ(split({1}, "both.adit").code, 2);
  EXPECT_FALSE(fs::exists(folder_ / "out.adit"));
  const MapDatabase writer(folder_ / "both.adit", MapAccess::write);
  const Ran busy = split({1}, "out.adit");
  EXPECT_EQ(busy.code, 1);
  EXPECT_NE(busy.err.find("is being written by"), std::string::npos) << busy.err;
  EXPECT_FALSE(fs::exists(folder_ / "out.adit"));
}

}  // namespace
}  // namespace adit
