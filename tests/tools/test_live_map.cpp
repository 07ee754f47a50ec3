// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/live_map.hpp"

#include <gtest/gtest.h>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/publishing/ros_values.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit {
namespace {

constexpr double kStep = 4.0;  // m between keyframes

Eigen::Isometry3d at(double x, double y) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, 0.0));
}

/// A wall 2 m to the left of the sensor, of points 0.1 m apart and as high as it is.
KeyframeSubmap wall(Nanoseconds stamp) {
  KeyframeSubmap submap;
  submap.r_submap = 0.1;
  submap.vertical = Vertical::gravity;
  submap.sweeps = {{.stamp = stamp, .T_keyframe_lidar = at(0.0, 0.0), .merged = true}};
  for (int i = -10; i < 10; ++i) {
    SubmapPoint point;
    point.place = {static_cast<int32_t>((0.1 * i + 0.01) * kSubmapSteps),
                   static_cast<int32_t>(2.01 * kSubmapSteps), 0};
    submap.points.push_back(point);
  }
  return submap;
}

class LiveMapTest : public ::testing::Test {
 protected:
  LiveMapTest() : map_(file_, MapAccess::write) { session_ = map_.add_session({.name = "one"}); }

  void store(NodeId id) {
    KeyframeRecord record;
    record.keyframe = {.id = id,
                       .session = session_,
                       .stamp = std::chrono::seconds(id + 1),
                       .T_map_keyframe = at(kStep * static_cast<double>(id), 0.0)};
    record.submap = encode(wall(record.keyframe.stamp));
    map_.store(record);
  }
  void move(NodeId id, const Eigen::Isometry3d& pose) {
    MapRevision revision;
    revision.poses = {{.id = id, .T_map_node = pose}};
    map_.revise(revision);
  }
  LiveMapChange read() {
    return live_.read(file_, [] { return false; });
  }
  int8_t cell(double x, double y) const {
    const OccupancyCells cells = live_.grid().cells_around({x, y}, 1e-3);
    return cells.values.empty() ? int8_t{-1} : cells.values.front();
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "map.adit";
  MapDatabase map_;
  SessionId session_ = 0;
  LiveMap live_;
};

TEST_F(LiveMapTest, KeyframesAreAddedAsTheyComeAndNotTwice) {
  store(0);
  LiveMapChange change = read();
  EXPECT_TRUE(change.keyframes && change.points);
  EXPECT_EQ(live_.points().size(), 10U) << "one in each voxel of 0.2 m";
  store(1);
  change = read();
  EXPECT_TRUE(change.keyframes && change.points);
  EXPECT_EQ(live_.points().size(), 20U);
  ASSERT_EQ(live_.keyframes().size(), 2U);
  EXPECT_EQ(live_.keyframes()[1].stamp, std::chrono::seconds(2));
  EXPECT_EQ(live_.keyframes()[1].T_map_lidar.translation().x(), kStep);
  change = read();
  EXPECT_FALSE(change.keyframes || change.points);
}

TEST_F(LiveMapTest, CellsAreOccupiedAtTheWallAndFreeBeforeIt) {
  store(0);
  read();
  EXPECT_EQ(cell(0.01, 2.01), 100);
  EXPECT_EQ(cell(0.0, 1.0), 0);
  EXPECT_EQ(cell(0.0, 2.5), -1);
  EXPECT_EQ(cell(50.0, 50.0), -1);
}

TEST_F(LiveMapTest, WhatAKeyframeSawMovesWithIt) {
  store(0);
  store(1);
  read();
  move(1, at(kStep, 0.01));
  LiveMapChange change = read();
  EXPECT_TRUE(change.keyframes);
  EXPECT_FALSE(change.points) << "less than a cell";
  move(1, at(kStep, 1.0));
  change = read();
  EXPECT_TRUE(change.keyframes && change.points);
  EXPECT_EQ(live_.points().size(), 20U);
  EXPECT_EQ(cell(kStep + 0.01, 3.01), 100);
  EXPECT_NE(cell(kStep + 0.01, 2.01), 100);
  EXPECT_EQ(cell(0.01, 2.01), 100);
}

TEST_F(LiveMapTest, AReadingThatIsStoppedIsGoneOnWith) {
  store(0);
  store(1);
  int asked = 0;
  live_.read(file_, [&] { return asked++ == 1; });
  EXPECT_EQ(live_.keyframes().size(), 1U);
  read();
  EXPECT_EQ(live_.keyframes().size(), 2U);
  EXPECT_EQ(live_.points().size(), 20U);
}

TEST(RosOccupancyGrid, ComesBackFromCdrAsItWas) {
  const std::vector<int8_t> cells = {-1, 0, 100, 0, 0, -1};
  ros::OccupancyGrid grid;
  grid.header = ros_header(std::chrono::seconds(5), "map");
  grid.map_load_time = Nanoseconds(1'500'000'000);
  grid.resolution = 0.05F;
  grid.width = 3;
  grid.height = 2;
  grid.origin.position = {.x = -1.0, .y = 2.0, .z = 0.0};
  grid.data = std::as_bytes(std::span(cells));
  const std::vector<std::byte> bytes = ros::encode(Encoding::cdr, grid);
  // As nav_msgs/msg/OccupancyGrid is laid out: header 4 + 8 + 8 ("map" with its end), time 8, three
  // numbers 12, 4 to align, pose 56, count 4, cells.
  EXPECT_EQ(bytes.size(), 4U + 8 + 8 + 8 + 12 + 4 + 56 + 4 + 6);
  const auto back = ros::decode<ros::OccupancyGrid>(Encoding::cdr, bytes);
  EXPECT_EQ(back.width, 3U);
  EXPECT_EQ(back.map_load_time, grid.map_load_time);
  EXPECT_EQ(back.origin.position.y, 2.0);
  EXPECT_TRUE(std::ranges::equal(back.data, grid.data));
}

}  // namespace
}  // namespace adit
