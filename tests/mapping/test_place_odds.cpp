// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A sensor that is carried elsewhere while it is localised in a map.
#include <gtest/gtest.h>

#include "adit/slam/mapping/place_odds.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/mapping/street_maps.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using Kind = PlaceLikeness::Kind;

PendingLoop found_by_position(NodeId from, CandidateVerdict verdict, LoopReason reason) {
  PendingLoop one;
  one.loop = {.id = 1, .from = from, .to = 9, .source = LoopSource::position};
  one.record = {
      .id = 1, .from = from, .to = 9, .verdict = verdict, .reason = std::string(to_string(reason))};
  return one;
}

/// Keyframes 0 to 4 of a map, 2 m apart, and keyframe 9 of a session beside the second.
PoseGraph row_of_keyframes() {
  PoseGraph graph;
  for (NodeId id = 0; id < 5; ++id) {
    graph.add_node({.id = id, .T_map_node = test::step(2.0 * static_cast<double>(id))});
  }
  graph.add_node({.id = 9, .T_map_node = test::step(2.0)});
  return graph;
}

TEST(PlaceOdds, WhatTheMapHasNearbyIsAlikeOrDifferent) {
  const PoseGraph graph = row_of_keyframes();
  const auto kind = [&](std::vector<PendingLoop> found) {
    return likeness_by_position(graph, 9, found, 5);
  };
  using enum CandidateVerdict;
  EXPECT_EQ(kind({}), Kind::not_mapped);
  EXPECT_EQ(kind({found_by_position(4, rejected, LoopReason::too_little_overlap)}),
            Kind::not_mapped)
      << "6 m away another view may differ";
  EXPECT_EQ(kind({found_by_position(1, rejected, LoopReason::too_little_overlap)}),
            Kind::different);
  EXPECT_EQ(kind({found_by_position(1, rejected, LoopReason::poor_fit),
                  found_by_position(2, waiting, LoopReason::none)}),
            Kind::alike);
  EXPECT_EQ(kind({found_by_position(1, rejected, LoopReason::degenerate)}), Kind::alike);
  EXPECT_EQ(
      likeness_by_position(
          graph, 9, std::vector{found_by_position(1, rejected, LoopReason::too_little_overlap)}, 1),
      Kind::not_mapped)
      << "a keyframe of the session itself";
  PendingLoop by_looks = found_by_position(1, rejected, LoopReason::too_little_overlap);
  by_looks.loop.source = LoopSource::appearance;
  EXPECT_EQ(kind({by_looks}), Kind::not_mapped);
}

TEST(PlaceOdds, FiveThatDifferOnTenMetresAreAnotherPlace) {
  PlaceOdds odds;
  EXPECT_TRUE(odds.is_sure());
  NodeId id = 0;
  for (int i = 0; i < 4; ++i) {
    odds.add(++id, Kind::different, 2.0);
    EXPECT_FALSE(odds.is_elsewhere());
  }
  EXPECT_FALSE(odds.is_sure());
  odds.add(++id, Kind::not_mapped, 2.0);
  EXPECT_FALSE(odds.is_elsewhere());
  odds.add(++id, Kind::different, 2.0);
  EXPECT_TRUE(odds.is_elsewhere());
  EXPECT_EQ(odds.different_since(), 1);
}

TEST(PlaceOdds, OneThatIsAlikeRestoresThem) {
  PlaceOdds odds;
  for (NodeId id = 0; id < 40; ++id) {
    odds.add(id, id % 4 == 3 ? Kind::alike : Kind::different, 2.0);
    EXPECT_FALSE(odds.is_elsewhere());
  }
  EXPECT_TRUE(odds.is_sure());
  EXPECT_FALSE(odds.different_since().has_value());
}

TEST(PlaceOdds, WhoStandsStillSeesTheSameAgain) {
  PlaceOdds odds;
  for (NodeId id = 0; id < 40; ++id) {
    odds.add(id, Kind::different, 0.01);
  }
  EXPECT_TRUE(odds.is_sure());
  EXPECT_FALSE(odds.is_elsewhere());
}

class Kidnapped : public test::DeviceTest {
 protected:
  static constexpr Nanoseconds kBetween{100000000};

  /// 25 m of the street, and from one sweep to the next on from 42 m.
  static test::SubmapDrive carried() {
    test::SubmapDrive drive = test::street_drive({.aside = 0.3, .sweeps = 50});
    const Nanoseconds next = drive.truth.back().stamp - drive.truth.front().stamp + kBetween;
    test::SubmapDrive rest =
        test::street_drive({.from = 42.0, .aside = 0.3, .sweeps = 56, .later = next});
    std::ranges::move(rest.truth, std::back_inserter(drive.truth));
    std::ranges::move(rest.sweeps, std::back_inserter(drive.sweeps));
    return drive;
  }
};

TEST_F(Kidnapped, IsLostAtOnceAndLocalizedAgain) {
  test::TemporaryFolder folder;
  test::write_street_map(context(), folder / "map.adit", {.sweeps = 140});
  MapDatabase store(folder / "map.adit", MapAccess::write);
  const test::SubmapDrive drive = carried();
  const auto slam = make_slam(context(), test::loop_config(true),
                              {.inertial = false,
                               .map = &store,
                               .session = store.add_session({.name = "carried"}),
                               .earlier_sessions = EarlierSessions::keep,
                               .start = StartPlace{.position = {0.0, 0.3, 0.0}, .heading = 0.0}});
  std::size_t i = 0;
  std::size_t localized = 0;
  const auto look = [&] {
    while (const auto result = slam->next()) {
      const auto* placed = std::get_if<SweepPlaced>(&*result);
      if (placed == nullptr) {
        continue;
      }
      const Localization& found = placed->mapped->localization;
      const double off =
          (placed->mapped->T_map_lidar.translation() - drive.truth[i].pose.translation()).norm();
      const bool is_localized = found.state == LocalizationState::localized;
      EXPECT_TRUE(!is_localized || off < 0.5) << "sweep " << i << " errs by " << off << " m";
      localized += is_localized && i < 50 ? 1U : 0U;
      ++i;
    }
  };
  for (const Sweep& sweep : drive.sweeps) {
    slam->add(sweep);
    look();
  }
  const MapReport report = *slam->finish_map();
  EXPECT_GT(localized, 10U) << "it was localised before";
  EXPECT_EQ(report.localization.state, LocalizationState::localized);
  EXPECT_EQ(report.localization.losses, 1U);
  EXPECT_EQ(report.localization.recoveries, 1U);
  EXPECT_GT(report.localization.longest_loss, 5.0);
  EXPECT_LT(report.localization.longest_loss, 25.0);
  EXPECT_GT(report.localization.keyframes[static_cast<std::size_t>(LocalizationState::lost)], 0U);
  EXPECT_TRUE(store.check().empty());
  EXPECT_LT((store.keyframes().back().T_map_keyframe.translation() -
             drive.truth.back().pose.translation())
                .norm(),
            2.0);
}

}  // namespace
}  // namespace adit
