// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps that are joined by ties of pairs.
#include <algorithm>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/mapping/map_ties.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_merge/tie_file.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

using Eigen::Isometry3d;

/// Maps of six keyframes, 10 m apart, each in a frame of its own; in the world they begin 30 m
/// after one another, so that each has half of its way in common with the next.
class MapTies : public ::testing::Test {
 protected:
  static constexpr std::size_t kMaps = 4;

  MapTies() {
    for (std::size_t map = 0; map < kMaps; ++map) {
      const auto file = folder_ / ("map" + std::to_string(map) + ".adit");
      {
        MapDatabase writer(file, MapAccess::write);
        const SessionId session = test::add_session(writer);
        for (NodeId id = 0; id < 6; ++id) {
          writer.store(test::record_of_a_point(id, session));
        }
      }
      databases_.push_back(std::make_unique<MapDatabase>(file, MapAccess::read));
      maps_.push_back(databases_.back().get());
    }
  }

  /// The pose of a map's keyframe in the world: a long curve.
  static Isometry3d T_world(std::size_t map, NodeId keyframe) {
    return Isometry3d(Eigen::Translation3d(30.0 * static_cast<double>(map), 0.0, 0.0)) *
           test::step(10.0 * static_cast<double>(keyframe));
  }

  /// By four loops, all off by `error`.
  static MapTie tie(std::size_t one, std::size_t other,
                    const Isometry3d& error = Isometry3d::Identity()) {
    MapTie tie{.one = one, .other = other};
    tie.search = {.candidates = 5, .verified = 4, .accepted = 4, .keyframes = 4, .is_tied = true};
    for (NodeId id = 0; id < 4; ++id) {
      const NodeId from = 2 + id;
      PoseEdge edge =
          test::edge(from, id, T_world(one, from).inverse() * T_world(other, id) * error, 400.0);
      edge.kind = EdgeKind::loop;
      tie.edges.push_back(edge);
      tie.candidates.push_back({.id = id + 1,
                                .from = from,
                                .to = id,
                                .T_from_to = edge.T_from_to,
                                .chi2 = std::numeric_limits<double>::infinity(),
                                .verdict = CandidateVerdict::accepted,
                                .reason = "none"});
    }
    return tie;
  }

  /// m, the worst keyframe relative to the first one.
  static double error_of(const MergedMap& merged) {
    const auto pose = [&](const MergedPart& part, NodeId keyframe) {
      return merged.graph.nodes()[merged.graph.index_of(part.merged(keyframe))].T_map_node;
    };
    const MergedPart& first = merged.parts.front();
    double worst = 0.0;
    for (const MergedPart& part : merged.parts) {
      for (const NodeId keyframe : part.stored) {
        const Isometry3d expected = T_world(first.map, 0).inverse() * T_world(part.map, keyframe);
        const Isometry3d found = pose(first, 0).inverse() * pose(part, keyframe);
        worst = std::max(worst, (expected.translation() - found.translation()).norm());
      }
    }
    return worst;
  }

  std::span<const MapStore* const> maps() const { return maps_; }
  const test::TemporaryFolder& folder() const { return folder_; }

 private:
  test::TemporaryFolder folder_;
  std::vector<std::unique_ptr<MapDatabase>> databases_;
  std::vector<const MapStore*> maps_;
};

TEST_F(MapTies, AChainOfMapsBecomesOne) {
  const std::vector<MapTie> ties = {tie(0, 1), tie(1, 2), tie(2, 3)};
  const JoinedMaps joined = join_maps(maps(), ties);
  EXPECT_EQ(joined.merged.parts.size(), 4U);
  EXPECT_EQ(joined.merged.graph.nodes().size(), 24U);
  EXPECT_EQ(joined.merged.candidates.size(), 12U);
  EXPECT_TRUE(joined.contradicted.empty());
  EXPECT_LT(error_of(joined.merged), 1e-3);
}

TEST_F(MapTies, TheirOrderMakesNoDifference) {
  std::vector<MapTie> ties = {tie(0, 1), tie(1, 2), tie(2, 3), tie(0, 2), tie(1, 3)};
  const JoinedMaps joined = join_maps(maps(), ties);
  std::ranges::reverse(ties);
  const JoinedMaps other = join_maps(maps(), ties);
  ASSERT_EQ(other.merged.graph.nodes().size(), joined.merged.graph.nodes().size());
  for (std::size_t i = 0; i < joined.merged.graph.nodes().size(); ++i) {
    EXPECT_TRUE(other.merged.graph.nodes()[i].T_map_node.matrix() ==
                joined.merged.graph.nodes()[i].T_map_node.matrix());
  }
}

TEST_F(MapTies, ATieThatTheOthersContradictIsLeftOut) {
  const std::vector<MapTie> ties = {
      tie(0, 1), tie(0, 3, test::step(25.0)), tie(1, 2), tie(2, 3), tie(0, 2), tie(1, 3)};
  const JoinedMaps joined = join_maps(maps(), ties);
  EXPECT_EQ(joined.contradicted, std::vector<std::size_t>{1});
  EXPECT_EQ(joined.merged.parts.size(), 4U);
  EXPECT_LT(error_of(joined.merged), 1e-3);
}

TEST_F(MapTies, OneEdgeThatDoesNotFitIsRevoked) {
  std::vector<MapTie> ties = {tie(0, 1), tie(1, 2), tie(2, 3)};
  PoseEdge wrong = ties[1].edges.front();
  wrong.information *= 0.01;  // with more it would be believed against the odometry
  wrong.from = 5;
  wrong.to = 0;
  wrong.T_from_to = T_world(1, 5).inverse() * T_world(2, 0) * test::step(3.0);
  ties[1].edges.push_back(wrong);
  LoopCandidate record = ties[1].candidates.front();
  record.from = wrong.from;
  record.to = wrong.to;
  ties[1].candidates.push_back(record);
  const JoinedMaps joined = join_maps(maps(), ties);
  EXPECT_TRUE(joined.contradicted.empty());
  EXPECT_EQ(std::ranges::count(joined.merged.graph.edges(), EdgeStatus::revoked, &PoseEdge::status),
            1);
  EXPECT_EQ(std::ranges::count(joined.merged.candidates, CandidateVerdict::revoked,
                               &LoopCandidate::verdict),
            1);
  EXPECT_LT(error_of(joined.merged), 0.05);
}

TEST_F(MapTies, MapsThatNothingTiesStayApart) {
  MapTie none = tie(0, 3);
  none.search.is_tied = false;
  const std::vector<MapTie> ties = {none, tie(1, 2)};
  const JoinedMaps joined = join_maps(maps(), ties);
  ASSERT_EQ(joined.merged.parts.size(), 2U);
  EXPECT_EQ(joined.merged.parts.front().map, 1U);
  EXPECT_EQ(joined.merged.parts.back().map, 2U);
  EXPECT_EQ(join_maps(maps(), {}).merged.parts.size(), 1U);
}

TEST_F(MapTies, AreReadBackAsTheyWereWritten) {
  const MapTie written = tie(0, 1, test::step(0.1, 0.2));
  const auto file = folder().write("tie.json", to_json(written));
  const MapTie read = read_tie(file, 0, 1);
  EXPECT_EQ(to_json(read), to_json(written));
  ASSERT_EQ(read.edges.size(), 4U);
  EXPECT_TRUE(read.edges[2].T_from_to.matrix() == written.edges[2].T_from_to.matrix());
  EXPECT_TRUE(read.edges[2].information == written.edges[2].information);
  EXPECT_EQ(read.candidates.size(), 4U);
}

TEST_F(MapTies, DamagedFilesAreRefused) {
  const std::string whole = to_json(tie(0, 1));
  std::mt19937 random(7);
  int refused = 0;
  for (int i = 0; i < 200; ++i) {
    std::string text = whole.substr(0, random() % whole.size());
    if (i % 2 == 0) {
      text = whole;
      text[random() % text.size()] = static_cast<char>(random() % 256);
    }
    const auto file = folder().write("tie.json", text);
    try {
      static_cast<void>(read_tie(file, 0, 1));
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("it is no tie of two maps"), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GE(refused, 100) << "all that is cut off, at least";
}

}  // namespace
}  // namespace adit
