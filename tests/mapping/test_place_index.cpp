// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/place_index.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

/// What the lidar sees of a street from (x, y), turned by `yaw`.
KeyframeSubmap submap_at(engine::Context& context, const test::World& world, double x, double y,
                         double yaw) {
  const test::Lidar lidar{.beams = 48, .columns = 480, .lowest = -0.4, .highest = 0.3};
  StampedPose pose;
  pose.stamp = Nanoseconds(static_cast<int64_t>(1e6 * (100.0 + x + 7.0 * y)));
  pose.pose.translation() = Eigen::Vector3d(x, y, 1.7);
  pose.pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Config config = test::submap_config();
  SubmapBuilder builder(context, config.preprocess, config.mapping.r_submap);
  const std::vector<Point> points = test::returns(test::scan(world, pose, lidar));
  builder.add({.stamp = pose.stamp,
               .T_odom_lidar = Eigen::Isometry3d::Identity(),
               .cloud = points,
               .gravity_odom = Eigen::Vector3d(0.0, 0.0, -9.81)});
  return builder.freeze(lidar.beam_spacing()).submap;
}

class PlaceIndexTest : public test::DeviceTest {
 protected:
  static PlaceDescriptor add(PlaceIndex& index, double x, double y, double yaw) {
    const KeyframeSubmap submap = submap_at(context(), test::make_street(80.0), x, y, yaw);
    return index.add(make_surface_cloud(context(), submap), plan_cell(submap.r_submap));
  }
};

TEST_F(PlaceIndexTest, APlaceIsFoundAgainWhicheverWayItIsSeen) {
  PlaceIndex index(context());
  constexpr std::size_t kPlaces = 21;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    add(index, 4.0 * static_cast<double>(i), 0.0, 0.0);
  }
  for (const double yaw : {0.0, 3.1, 1.5}) {
    for (const double aside : {0.0, 1.0, -2.0}) {
      add(index, 40.5, aside, yaw);
      std::vector<SimilarPlace> similar = index.similar();
      similar.resize(kPlaces);
      EXPECT_EQ(std::ranges::max_element(similar, {}, &SimilarPlace::similarity)->place, 10U)
          << yaw << ' ' << aside;
      const PlaceGuess guess = index.guesses(std::span(&similar[10], 1)).front();
      EXPECT_EQ(guess.place, 10U);
      const Eigen::Vector3d& at = guess.T_place_newest.translation();
      EXPECT_LT((at - Eigen::Vector3d(0.5, aside, 0.0)).norm(), 0.8) << yaw << ' ' << aside;
      const Eigen::Vector3d ahead = guess.T_place_newest.linear().col(0);
      EXPECT_LT(std::abs(std::remainder(std::atan2(ahead.y(), ahead.x()) - yaw, 2.0 * M_PI)), 0.04);
      EXPECT_GT(guess.likeness, 0.6);
    }
  }
}

TEST_F(PlaceIndexTest, WhatIsUnknownOrEmptyIsLikeNothing) {
  PlaceIndex index(context());
  EXPECT_TRUE(index.similar().empty());
  add(index, 0.0, 0.0, 0.0);
  EXPECT_TRUE(index.similar().empty()) << "nothing before it";
  index.add_unknown();
  EXPECT_TRUE(index.similar().empty());
  EXPECT_TRUE(index.guesses(std::vector<SimilarPlace>{{.place = 0}}).empty());
  add(index, 4.0, 0.0, 0.0);
  ASSERT_EQ(index.similar().size(), 1U) << "not with the unknown one";
  EXPECT_EQ(index.similar()[0].place, 0U);
  const SurfaceCloud nothing = make_surface_cloud(context(), KeyframeSubmap());
  const PlaceDescriptor empty = index.add(nothing, 0.5);
  EXPECT_EQ(empty, PlaceDescriptor{.cell = 0.5});
  EXPECT_TRUE(index.similar().empty());
  EXPECT_EQ(index.size(), 4U);
}

TEST_F(PlaceIndexTest, ADescriptorIsStoredWithItsSubmapAndMissesInOlderOnes) {
  PlaceIndex index(context());
  const KeyframeSubmap submap = submap_at(context(), test::make_street(80.0), 0.0, 0.0, 0.0);
  const PlaceDescriptor descriptor =
      index.add(make_surface_cloud(context(), submap), plan_cell(submap.r_submap));
  MapSubmap stored = encode(submap, descriptor);
  EXPECT_EQ(decode_descriptor(stored), descriptor);
  EXPECT_EQ(decode(stored).points.size(), submap.points.size());
  EXPECT_EQ(decode_descriptor(encode(submap)), std::nullopt);
  std::vector<std::byte>& chunk = stored.chunks[kPlaceChunk];
  chunk[20] ^= std::byte{1};
  EXPECT_THROW(static_cast<void>(decode_descriptor(stored)), SubmapDamaged);
  chunk.resize(5);
  EXPECT_THROW(static_cast<void>(decode_descriptor(stored)), SubmapDamaged);
}

}  // namespace
}  // namespace adit
