// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is different between two sessions in one street.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/submaps/changed_objects.hpp"
#include "adit/slam/submaps/session_changes.hpp"
#include "adit/slam/submaps/submap_builder.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

constexpr double kObjectEdge = 0.25;  // m
const SpaceTile kStreet{.centre = {40, 0, 0}, .across = 320};
const test::Block kBox{{9.0, 1.4, 0.0}, {10.4, 2.8, 1.3}};
const test::Block kOther{{13.0, -2.9, 0.0}, {14.2, -1.7, 1.1}};

using Submaps = std::vector<SessionSubmap>;

class SessionChanges : public test::DeviceTest {
 protected:
  /// Submaps of a sweep each along a street with these blocks in it, `lift` m too high in the map.
  static Submaps session(uint32_t number, const std::vector<test::Block>& blocks,
                         bool with_traffic = false, double lift = 0.0) {
    const test::Lidar lidar{.beams = 40, .columns = 600};
    PreprocessConfig preprocess = test::submap_config().preprocess;
    preprocess.beam_spacing = lidar.beam_spacing();
    SubmapBuilder builder(context(), preprocess, 0.2);
    Submaps submaps;
    for (const StampedPose& pose : test::steady_drive(7, test::twist(1.2))) {
      test::World world = test::make_street(30.0);
      world.blocks.insert(world.blocks.end(), blocks.begin(), blocks.end());
      if (with_traffic) {
        const double x = 20.0 - 2.5 * static_cast<double>(submaps.size()) - 3.0 * number;
        world.blocks.push_back({{x, -1.4, 0.0}, {x + 4.2, 0.4 - 1.0, 1.5}});
      }
      const Sweep sweep = test::scan(world, pose, lidar, number + 1);
      const std::vector<Point> cloud = test::returns(sweep);
      builder.add({.stamp = pose.stamp, .T_odom_lidar = pose.pose, .cloud = cloud});
      const FrozenSubmap frozen = builder.freeze(lidar.beam_spacing());
      submaps.push_back(
          {.placed = {.T_map_keyframe =
                          Eigen::Translation3d(0.0, 0.0, lift) * frozen.T_odom_keyframe,
                      .submap = std::make_shared<const KeyframeSubmap>(frozen.submap)},
           .session = number});
    }
    return submaps;
  }

  /// The first session with the box alone, made once.
  static const Submaps& before() {
    static const Submaps submaps = session(0, {kBox});
    return submaps;
  }

  static Submaps both(Submaps before, const Submaps& after) {
    before.insert(before.end(), after.begin(), after.end());
    return before;
  }

  static std::vector<ChangedVoxel> changes(const Submaps& submaps,
                                           const SpaceTile& tile = kStreet) {
    return changes_in_tile(
               tile, kObjectEdge, submaps.size(), [&](std::size_t i) { return submaps[i]; },
               kLeastLogOdds)
        .voxels;
  }

  struct Object {
    ChangeOfSpace change;
    std::size_t points = 0;
    std::size_t inside = 0;  ///< of them, in the block
  };

  static std::vector<Object> objects(const std::vector<ChangedVoxel>& voxels,
                                     const test::Block& block) {
    std::vector<Object> found;
    const Eigen::AlignedBox3d box(block.low - Vector3d::Constant(0.1),
                                  block.high + Vector3d::Constant(0.1));
    for (const std::vector<std::size_t>& members : changed_objects(voxels, 8)) {
      Object object{.change = voxels[members.front()].change};
      for (const std::size_t member : members) {
        for (const Vector3d& point : voxels[member].points) {
          ++object.points;
          object.inside += box.contains(point) ? 1U : 0U;
        }
      }
      found.push_back(object);
    }
    return found;
  }
};

TEST_F(SessionChanges, ABoxThatIsTakenAwayIsGoneAndOneThatIsPutThereIsNew) {
  const Submaps submaps = both(before(), session(1, {kOther}));
  const std::vector<ChangedVoxel> voxels = changes(submaps);
  const std::vector<Object> gone = objects(voxels, kBox);
  const std::vector<Object> added = objects(voxels, kOther);
  ASSERT_EQ(gone.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Object& object = gone[i].change == ChangeOfSpace::gone ? gone[i] : added[i];
    EXPECT_GT(object.points, 40U);
    EXPECT_GT(object.inside, object.points * 9 / 10);
  }
  EXPECT_NE(gone[0].change, gone[1].change);
  for (const ChangedVoxel& voxel : voxels) {
    EXPECT_GE(voxel.through, 2U);
    EXPECT_EQ(voxel.session, voxel.change == ChangeOfSpace::gone ? 0U : 1U);
    EXPECT_EQ(voxel.other, 1U - voxel.session);
  }
}

TEST_F(SessionChanges, WhatMovesDuringASessionIsNoChange) {
  const Submaps submaps = both(session(0, {kBox}, true), session(1, {kBox}, true));
  EXPECT_TRUE(objects(changes(submaps), kBox).empty());
}

TEST_F(SessionChanges, WhatIsHiddenIsUnknown) {
  const test::Block wall{{-2.0, 0.9, 0.0}, {14.0, 1.1, 3.0}};  // between the road and the box
  const Submaps submaps = both(before(), session(1, {wall}));
  for (const Object& object : objects(changes(submaps), kBox)) {
    EXPECT_EQ(object.change, ChangeOfSpace::appeared) << "the wall alone is known";
    EXPECT_EQ(object.inside, 0U);
  }
}

TEST_F(SessionChanges, AMisplacedSessionSaysNothing) {
  const Submaps submaps = both(before(), session(1, {kBox}, false, 0.7));
  EXPECT_TRUE(objects(changes(submaps), kBox).empty());
}

TEST_F(SessionChanges, OneSessionOrNoneHasNoChangesAndDamagedPosesAreSurvived) {
  EXPECT_TRUE(changes({}).empty());
  EXPECT_TRUE(changes(before()).empty());
  Submaps submaps = both(before(), session(1, {}));
  const double nan = std::nan("");
  submaps[1].placed.T_map_keyframe.translation() = Vector3d(nan, 0.0, 1e300);
  submaps[8].placed.T_map_keyframe.translation() = Vector3d(1e17, 0.0, -1e17);
  EXPECT_FALSE(changes(submaps).empty());
}

TEST_F(SessionChanges, OfTilesEachHasItsOwnVoxels) {
  const Submaps submaps = both(before(), session(1, {}));
  std::size_t found = 0;
  for (const int64_t x : {-40, 120}) {
    for (const int64_t y : {-80, 80}) {
      found += changes(submaps, {.centre = {x, y, 0}, .across = 160}).size();
    }
  }
  const auto whole = static_cast<double>(changes(submaps).size());
  EXPECT_NEAR(static_cast<double>(found), whole, 0.1 * whole);
}

TEST(ChangeLogOdds, RaysThatPassSpeakForAChangeAndHitsAgainstIt) {
  EXPECT_EQ(change_log_odds(5, 0, 0, 0), 0.0);
  EXPECT_GT(change_log_odds(5, 0, 0, 2), kChangedLogOdds);
  EXPECT_GT(change_log_odds(5, 0, 0, 3), change_log_odds(5, 0, 0, 2));
  EXPECT_LT(change_log_odds(5, 0, 1, 3), change_log_odds(5, 0, 0, 3));
  EXPECT_LT(change_log_odds(2, 8, 0, 3), 1.0) << "leaves: their own session sees through as often";
  EXPECT_LT(change_log_odds(5, 0, 5, 0), -5.0);
}

TEST(ChangedObjects, VoxelsThatTouchAreOneObject) {
  const auto voxel = [](int64_t x, double log_odds, ChangeOfSpace change = ChangeOfSpace::gone) {
    return ChangedVoxel{.voxel = {x, 0, 0},
                        .change = change,
                        .log_odds = log_odds,
                        .points = std::vector<Vector3d>(4, Vector3d::Zero())};
  };
  const std::vector<ChangedVoxel> voxels = {voxel(0, 5.0), voxel(1, 1.0),
                                            voxel(2, 1.0), voxel(4, 5.0),
                                            voxel(5, 5.0), voxel(5, 5.0, ChangeOfSpace::appeared)};
  using Objects = std::vector<std::vector<std::size_t>>;
  EXPECT_EQ(changed_objects(voxels, 1), (Objects{{0, 1}, {3, 4}, {5}})) << "2 is next to no strong";
  EXPECT_EQ(changed_objects(voxels, 8), (Objects{{0, 1}, {3, 4}}));
  EXPECT_TRUE(changed_objects({}, 1).empty());
}

}  // namespace
}  // namespace adit
