// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/truth_on_map.hpp"

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

/// Keyframes on a bend, so that positions determine how the truth lies: 10 m a step, and a turn.
Eigen::Isometry3d bent(NodeId id) {
  const double angle = 0.4 * static_cast<double>(id);
  Eigen::Isometry3d pose(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  pose.translation() = 25.0 * Eigen::Vector3d(std::sin(angle), 1.0 - std::cos(angle), 0.0);
  return pose;
}

class TruthOnMapTest : public testing::Test {
 protected:
  /// Two parts of four keyframes each: nothing ties 3 to 4.
  void write(MapDatabase& map) {
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 8; ++id) {
      KeyframeRecord record = test::record_of_a_point(id, session);
      record.keyframe.T_map_keyframe = bent(id);
      if (id == 0 || id == 4) {
        record.edges.clear();
      }
      map.store(record);
      const auto stamp = record.keyframe.stamp;
      // The second part lies elsewhere in the world.
      const Eigen::Isometry3d T_world_map =
          se3_exp((Vector6d() << 5.0, id < 4 ? 0.0 : 100.0, 1.0, 0.0, 0.1, 0.7).finished());
      truth_.poses.push_back({.stamp = stamp, .pose = T_world_map * bent(id)});
    }
    truth_.stamped = true;
  }

  test::TemporaryFolder folder_;
  Trajectory truth_;
};

TEST_F(TruthOnMapTest, EachPartIsLaidOntoTheTruthByItself) {
  MapDatabase map(folder_ / "map.adit", MapAccess::write);
  write(map);
  truth_.poses[2].pose.translation().z() += 0.4;  // the truth is elsewhere there
  const TruthOnMap laid = truth_on_map(map, truth_);
  ASSERT_EQ(laid.errors.size(), 8U);
  for (const NodeId id : {4, 5, 6, 7}) {
    EXPECT_LT(laid.errors.at(id), 1e-9) << id;
  }
  EXPECT_GT(laid.errors.at(2), 0.1);
  ASSERT_EQ(laid.path.size(), 8U);
  EXPECT_LT((laid.path[6] - bent(6).translation()).norm(), 1e-9);
}

TEST_F(TruthOnMapTest, ATruthOfAnotherTimeIsRefused) {
  MapDatabase map(folder_ / "map.adit", MapAccess::write);
  write(map);
  for (StampedPose& pose : truth_.poses) {
    pose.stamp += std::chrono::hours(1);
  }
  EXPECT_THROW(truth_on_map(map, truth_), InputError);
}

}  // namespace
}  // namespace adit
