// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/edge_consistency.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/graph_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/evaluation/true_keyframes.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

constexpr NodeId kNodes = 400;
constexpr double kMetres = 0.02;
constexpr double kRadians = 0.003;

/// Keyframes that lean, a metre and a second apart, tied by edges with errors of those deviations
/// that claim `promised` times as much.
std::optional<EdgeConsistency> of_edges(double promised) {
  const test::TemporaryFolder folder;
  const auto file = folder / "map.adit";
  Trajectory truth;
  Eigen::Isometry3d T_keyframe_lidar = Eigen::Isometry3d::Identity();
  T_keyframe_lidar.linear() = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  Matrix6d information = Matrix6d::Identity() / std::pow(promised * kRadians, 2);
  information.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / std::pow(promised * kMetres, 2);
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = map.add_session({.name = "test"});
    Random random(3);
    Eigen::Isometry3d last = Eigen::Isometry3d::Identity();
    for (NodeId id = 0; id < kNodes; ++id) {
      const Nanoseconds stamp = std::chrono::seconds(id);
      const Eigen::Isometry3d lidar =
          test::step(static_cast<double>(id), 0.01 * static_cast<double>(id));
      const Eigen::Isometry3d keyframe = lidar * T_keyframe_lidar.inverse();
      truth.poses.push_back({.stamp = stamp, .pose = lidar});
      KeyframeSubmap submap{.r_submap = 0.2, .sweeps = {}, .points = {}};
      submap.sweeps.push_back(
          {.stamp = stamp, .T_keyframe_lidar = T_keyframe_lidar, .merged = true});
      KeyframeRecord record{.keyframe = {.id = id, .session = session, .stamp = stamp},
                            .submap = encode(submap)};
      if (id > 0) {
        Vector6d error;
        for (int i = 0; i < 6; ++i) {
          error[i] = random.gaussian() * (i < 3 ? kMetres : kRadians);
        }
        record.edges.push_back({.from = id - 1,
                                .to = id,
                                .T_from_to = last.inverse() * keyframe * se3_exp(error),
                                .information = information});
      }
      map.store(record);
      last = keyframe;
    }
  }
  return edge_consistency(file, truth);
}

TEST(EdgeConsistency, IsOneWhereEdgesErrAsTheyPromise) {
  const auto right = of_edges(1.0);
  ASSERT_TRUE(right);
  EXPECT_EQ(right->edges, static_cast<std::size_t>(kNodes - 1));
  EXPECT_NEAR(right->nees, 1.0, 0.1);
  EXPECT_NEAR(right->translation, 1.0, 0.15);
  EXPECT_NEAR(right->rotation, 1.0, 0.15);
  EXPECT_NEAR(right->rms_translation, std::sqrt(3.0) * kMetres, 0.1 * kMetres);
  EXPECT_NEAR(right->rms_rotation, std::sqrt(3.0) * kRadians, 0.1 * kRadians);
  const auto timid = of_edges(2.0);
  ASSERT_TRUE(timid);
  EXPECT_NEAR(timid->nees, 0.25 * right->nees, 1e-9);
}

TEST(TruePoses, AreInterpolatedOrAtMostAFewMillisecondsAway) {
  using std::chrono::milliseconds;
  Trajectory truth;
  for (const int at : {0, 100, 1000}) {
    truth.poses.push_back({.stamp = milliseconds(at), .pose = test::step(0.01 * at)});
  }
  const auto x_at = [&](int stamp) {
    const auto pose = pose_at(truth, milliseconds(stamp));
    return pose ? std::optional(pose->translation().x()) : std::nullopt;
  };
  EXPECT_EQ(x_at(100), 1.0);
  EXPECT_NEAR(x_at(25).value_or(-1.0), 0.25, 1e-9);
  EXPECT_EQ(x_at(110), 1.0);
  EXPECT_EQ(x_at(985), 10.0);
  EXPECT_EQ(x_at(500), std::nullopt) << "nothing is known of so long a way";
  EXPECT_EQ(x_at(1100), std::nullopt);
}

}  // namespace
}  // namespace adit
