// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Sessions that are tied to the map of earlier ones: aliases, the store of a session over a map,
// and a street that is driven a second time.
#include <gtest/gtest.h>

#include "adit/slam/executor/slam.hpp"
#include "adit/slam/loops/map_aliases.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"
#include "adit/tools/map_database/session_over_map.hpp"

namespace adit {
namespace {

std::string lines_of(const MapDatabase& map) {
  std::string text;
  map.dump([&](std::string_view line) { text += std::string(line) + "\n"; });
  return text;
}

/// Two floors of a corridor, 3.4 m apart: nodes 0 to 9 below, 10 to 19 above, 4 m apart each.
PoseGraph two_floors() {
  PoseGraph graph;
  for (NodeId id = 0; id < 20; ++id) {
    Eigen::Isometry3d pose = test::step(4.0 * static_cast<double>(id % 10));
    pose.translation().z() = id < 10 ? 0.0 : 3.4;
    graph.add_node({.id = id, .T_map_node = pose});
  }
  return graph;
}

/// The keyframe above looks like the one below it.
LoopCandidate alike(NodeId below, LoopReason reason, double through = 0.012) {
  return {.id = below + 1,
          .from = below,
          .to = below + 10,
          .verdict = CandidateVerdict::rejected,
          .reason = std::string(to_string(reason)),
          .through = through};
}

TEST(MapAliases, EqualFloorsLookLikeEachOtherUpAndDown) {
  std::vector<LoopCandidate> candidates;
  for (NodeId id = 0; id < 4; ++id) {
    candidates.push_back(alike(id, LoopReason::against_odometry, 0.01 * static_cast<double>(id)));
  }
  const MapAliases aliases = map_aliases(two_floors(), candidates);
  ASSERT_EQ(aliases.all.size(), 2U);
  for (const MapAlias& alias : aliases.all) {
    EXPECT_EQ(alias.places(), 4U);
    EXPECT_NEAR(alias.mean_through(), 0.015, 1e-12);
    const Eigen::Vector3d moved = alias.moved(test::step(30.0)).translation();
    EXPECT_NEAR(std::abs(moved.z()), 3.4, 1e-12);
    EXPECT_NEAR(moved.x(), 30.0, 1e-12);
  }
  EXPECT_NE(aliases.all[0].moved(test::step(1.0)).translation().z(),
            aliases.all[1].moved(test::step(1.0)).translation().z());
}

TEST(MapAliases, FewPlacesOrThoseOfOneOwnAreNone) {
  const PoseGraph floors = two_floors();
  const std::vector<LoopCandidate> two = {alike(0, LoopReason::against_odometry),
                                          alike(1, LoopReason::against_odometry)};
  EXPECT_TRUE(map_aliases(floors, two).all.empty());
  std::vector<LoopCandidate> not_alike;
  std::vector<LoopCandidate> near;
  for (NodeId id = 0; id < 5; ++id) {
    not_alike.push_back(alike(id, LoopReason::too_little_overlap));
    LoopCandidate one = alike(id, LoopReason::against_odometry);
    one.T_from_to.translation() = Eigen::Vector3d(0.0, 0.5, 3.4);  // drift
    near.push_back(one);
  }
  EXPECT_TRUE(map_aliases(floors, not_alike).all.empty());
  EXPECT_TRUE(map_aliases(floors, near).all.empty());
}

TEST(MapAliases, AMapWhoseLoopsAreSeenThroughMoreIsHeldToThat) {
  const ThroughShares usual;
  std::vector<LoopCandidate> loops;
  for (NodeId id = 0; id < 10; ++id) {
    loops.push_back(alike(id, LoopReason::none, 2.0 * usual.right));
    loops.back().verdict = CandidateVerdict::accepted;
  }
  const ThroughShares shares = map_aliases(two_floors(), loops).through;
  EXPECT_NEAR(shares.right, 2.0 * usual.right, 1e-12);
  EXPECT_NEAR(shares.alike, 2.0 * usual.alike, 1e-12);
  loops.resize(5);
  EXPECT_EQ(map_aliases(two_floors(), loops).through.right, usual.right);
}

TEST(MapAliases, EqualWallsWithOtherThingsBetweenThemAreAnotherPlace) {
  const ThroughShares shares;
  EXPECT_NEAR(log_ratio_to_built_alike({}, shares), 0.0, 1e-12);
  std::vector<double> same(40, 0.001);
  same[7] = same[23] = 0.006;
  EXPECT_GT(log_ratio_to_built_alike(same, shares), 2.0);
  std::vector<double> alike(40, 0.001);  // most places have nothing that differs
  for (std::size_t i = 0; i < alike.size(); i += 5) {
    alike[i] = 0.014;
  }
  EXPECT_LT(log_ratio_to_built_alike(alike, shares), -4.0);
  EXPECT_LT(log_ratio_to_built_alike(std::vector<double>(500, 0.9), shares), -1000.0);
}

TEST(SessionOverMap, TheMapStaysAndTheSessionHasWhatIsItsOwn) {
  test::TemporaryFolder folder;
  test::write_full_map(folder / "map.adit");
  const MapDatabase map(folder / "map.adit", MapAccess::read);
  const std::string before = lines_of(map);
  MapDatabase own(folder / "own.adit", MapAccess::write);
  SessionOverMap over(map, own);
  const SessionId session = over.add_session({.name = "second"});
  const NodeId first = map.keyframes().back().id + 1;
  for (NodeId id = first; id < first + 3; ++id) {
    KeyframeRecord record = test::record(id, session);
    if (id == first) {
      record.edges.clear();
    }
    over.store(record);
  }
  const PoseEdge to_map = test::edge(0, first + 1, test::step(1.0), 100.0);
  const PoseEdge within = test::edge(first, first + 2, test::step(20.0), 100.0);
  LoopCandidate loop_to_map;
  loop_to_map.id = 70;
  loop_to_map.to = first + 1;
  over.revise({.edges = {to_map, within}, .candidates = {loop_to_map}});
  // Counted as the graph of both has its edges: the session's own two, the loop to the map, and the
  // one within.
  const std::size_t edges = map.graph().edges().size();
  over.revise({.statuses = {{edges + 2, EdgeStatus::revoked}, {edges + 3, EdgeStatus::revoked}},
               .poses = {{.id = 0, .T_map_node = test::step(77.0)},
                         {.id = first, .T_map_node = test::step(5.0)}},
               .drops_georeference = true});
  EXPECT_EQ(lines_of(map), before);
  ASSERT_EQ(own.keyframes().size(), 3U);
  EXPECT_TRUE(own.keyframes().front().T_map_keyframe.isApprox(test::step(5.0)));
  ASSERT_EQ(own.graph().edges().size(), 3U) << "the loop to the map is in neither";
  EXPECT_EQ(own.graph().edges()[2].status, EdgeStatus::revoked);
  EXPECT_EQ(own.graph().edges()[1].status, EdgeStatus::active);
  EXPECT_TRUE(own.candidates().empty());
  EXPECT_TRUE(own.georeference().has_value()) << "it is the map's";
  EXPECT_EQ(over.keyframes().size(), map.keyframes().size() + 3);
  EXPECT_EQ(over.submap(first).chunks, own.submap(first).chunks);
  EXPECT_EQ(over.submap(0).chunks, map.submap(0).chunks);
  EXPECT_TRUE(own.check().empty());
}

TEST(MapDatabase, ACopyHoldsTheSame) {
  test::TemporaryFolder folder;
  test::write_full_map(folder / "map.adit");
  const MapDatabase map(folder / "map.adit", MapAccess::read);
  map.copy_to(folder / "copy.adit");
  const MapDatabase copy(folder / "copy.adit", MapAccess::write);
  EXPECT_EQ(lines_of(copy), lines_of(map));
  EXPECT_TRUE(copy.check().empty());
}

/// A street of 60 m, mapped by one drive and driven again 0.4 m aside.
class SecondSession : public test::DeviceTest {
 protected:
  static constexpr std::size_t kSweeps = 90;

  static const test::SubmapDrive& drive(double aside, uint64_t street = 1) {
    static std::map<std::pair<double, uint64_t>, test::SubmapDrive> drives;
    const auto [known, is_new] = drives.try_emplace({aside, street});
    if (is_new) {
      known->second.truth = test::steady_drive(kSweeps, test::twist(0.5));
      for (StampedPose& pose : known->second.truth) {
        pose.pose = pose.pose * Eigen::Translation3d(0.0, aside, 0.0);
      }
      known->second.sweeps =
          test::scan_all(test::make_street(80.0, street), known->second.truth, test::small_lidar());
    }
    return known->second;
  }

  static MapReport mapped(MapStore& store, SessionId session, double aside, EarlierSessions earlier,
                          const std::optional<StartPlace>& start = {}, uint64_t street = 1) {
    const auto slam = make_slam(context(), test::loop_config(true),
                                {.inertial = false,
                                 .map = &store,
                                 .session = session,
                                 .earlier_sessions = earlier,
                                 .start = start});
    for (const Sweep& sweep : drive(aside, street).sweeps) {
      slam->add(sweep);
      while (slam->next()) {
      }
    }
    return *slam->finish_map();
  }
};

TEST_F(SecondSession, LiesInTheMapWhoseKeyframesStay) {
  test::TemporaryMap map;
  mapped(map.store(), map.session(), 0.0, EarlierSessions::none);
  const std::vector<MapKeyframe> before = map.store().keyframes();
  const SessionId second = map.store().add_session({.name = "second"});
  const MapReport report = mapped(map.store(), second, 0.4, EarlierSessions::keep);
  EXPECT_TRUE(report.localization.any());
  const std::vector<MapKeyframe> after = map.store().keyframes();
  ASSERT_GT(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].id, static_cast<NodeId>(i));
    EXPECT_EQ(after[i].session, i < before.size() ? map.session() : second);
    EXPECT_FALSE(after[i].fixed);
    if (i < before.size()) {
      EXPECT_EQ(after[i].T_map_keyframe.matrix(), before[i].T_map_keyframe.matrix());
    }
  }
  EXPECT_TRUE(map.store().check().empty());
  ASSERT_GT(report.localization.recognised, 0U);
  EXPECT_EQ(report.components, 1U);
  EXPECT_GT(report.localization.searched, 0.0);
  EXPECT_GT(report.localization.covariance.diagonal().minCoeff(), 0.0);
  const Eigen::Isometry3d T_map_world = drive(0.0).truth.front().pose.inverse();
  for (const MapKeyframe& keyframe : map.store().keyframes()) {
    if (keyframe.session != second) {
      continue;
    }
    const std::size_t i = static_cast<std::size_t>(
        std::ranges::find(drive(0.4).truth, keyframe.stamp, &StampedPose::stamp) -
        drive(0.4).truth.begin());
    const Eigen::Vector3d off = (T_map_world * drive(0.4).truth[i].pose).translation() -
                                keyframe.T_map_keyframe.translation();
    EXPECT_LT(off.norm(), 0.15) << "keyframe " << keyframe.id;
  }
}

/// Edges that say where the session was expected to begin, and still count.
std::size_t expectations(const MapStore& store) {
  return static_cast<std::size_t>(
      std::ranges::count_if(store.graph().edges(), [](const PoseEdge& edge) {
        return edge.kind == EdgeKind::start && edge.status == EdgeStatus::active;
      }));
}

TEST_F(SecondSession, IsRecognisedAtOnceWhereSomebodySaysItBegins) {
  test::TemporaryMap map;
  mapped(map.store(), map.session(), 0.0, EarlierSessions::none);
  const SessionId second = map.store().add_session({.name = "second"});
  const MapReport report = mapped(map.store(), second, 0.4, EarlierSessions::move,
                                  StartPlace{.position = {0.8, -0.2, 0.1}, .heading = 0.05});
  EXPECT_EQ(report.localization.start, StartSource::guess);
  EXPECT_FALSE(report.localization.start_contradicted);
  EXPECT_EQ(report.localization.state, LocalizationState::localized);
  EXPECT_EQ(report.localization.keyframes[static_cast<std::size_t>(LocalizationState::ambiguous)],
            0U);
  EXPECT_EQ(report.components, 1U);
  EXPECT_EQ(expectations(map.store()), 0U) << "a guess is no measurement";
  const MapKeyframe last = map.store().keyframes().back();
  const Eigen::Isometry3d T_map_world = drive(0.0).truth.front().pose.inverse();
  const auto truth = std::ranges::find(drive(0.4).truth, last.stamp, &StampedPose::stamp);
  ASSERT_NE(truth, drive(0.4).truth.end());
  EXPECT_LT(((T_map_world * truth->pose).translation() - last.T_map_keyframe.translation()).norm(),
            0.15);
}

TEST_F(SecondSession, StaysWhereItIsSaidToBeginWhereNothingConfirmsIt) {
  test::TemporaryMap map;
  mapped(map.store(), map.session(), 0.0, EarlierSessions::none);
  const SessionId second = map.store().add_session({.name = "another street"});
  const MapReport report = mapped(map.store(), second, 0.0, EarlierSessions::move,
                                  StartPlace{.position = {10.0, 1.0, 0.0}, .heading = 1.0}, 77);
  EXPECT_EQ(report.localization.recognised, 0U);
  EXPECT_EQ(report.components, 2U);
  EXPECT_EQ(expectations(map.store()), 0U);
  const auto keyframes = map.store().keyframes();
  const auto first = std::ranges::find(keyframes, second, &MapKeyframe::session);
  ASSERT_NE(first, keyframes.end());
  EXPECT_LT((first->T_map_keyframe.translation() - Eigen::Vector3d(10.0, 1.0, 0.0)).norm(), 0.5);
}

TEST_F(SecondSession, IsRecognisedElsewhereThanSomebodySays) {
  test::TemporaryMap map;
  mapped(map.store(), map.session(), 0.0, EarlierSessions::none);
  const SessionId second = map.store().add_session({.name = "second"});
  const MapReport report = mapped(map.store(), second, 0.4, EarlierSessions::move,
                                  StartPlace{.position = {30.0, 30.0, 0.0}, .heading = 2.0});
  EXPECT_TRUE(report.localization.start_contradicted);
  EXPECT_GT(report.localization.recognised, 0U);
  EXPECT_EQ(expectations(map.store()), 0U);
}

TEST_F(SecondSession, WithoutAnEarlierSessionNothingIsSearched) {
  test::TemporaryMap map;
  const MapReport report = mapped(map.store(), map.session(), 0.0, EarlierSessions::keep);
  EXPECT_FALSE(report.localization.any());
}

}  // namespace
}  // namespace adit
