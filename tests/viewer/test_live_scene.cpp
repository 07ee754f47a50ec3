// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/live_scene.hpp"

#include <array>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/maps/map_database.hpp"

namespace adit {
namespace {

using nlohmann::json;

/// A sweep every 0.1 s and 1 m, of a keyframe of its own or of none, with one point 2 m ahead.
LiveSweep sweep_at(int i, std::optional<NodeId> keyframe = std::nullopt, bool with_cloud = false) {
  const std::vector<Point> points = {{.x = 2.0F}};
  LiveSweep sweep{
      .stamp = Nanoseconds(1'000'000'000 + 100'000'000LL * i),
      .keyframe = keyframe,
      .points = sensor_cloud(points, 10),
      .progress = {.sweeps = static_cast<std::size_t>(i) + 1, .of = 9, .verdict = "reliable"}};
  sweep.T_map_lidar.translation().x() = i;
  if (with_cloud) {
    sweep.keyframe_cloud = sensor_cloud(points, 10);
  }
  return sweep;
}

json last_of(const ViewNews& news) {
  return json::parse(*news.texts.back());
}

uint32_t points_in(const std::string& tile) {
  std::array<uint32_t, 2> head{};
  std::memcpy(head.data(), tile.data(), sizeof(head));
  EXPECT_EQ(tile.size(), sizeof(head) + head[1] * sizeof(TilePoint));
  return head[1];
}

TEST(SensorCloudTest, HasWhatCameBackAboutTheSensor) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Point> points = {{.x = 4.0F, .y = -4.0F}, {}, {.x = nan}, {.z = 1.0F}};
  const SensorCloud cloud = sensor_cloud(points, 100);
  ASSERT_EQ(cloud.points.size(), 2U);
  const auto place = [&](std::size_t i, std::size_t k) {
    return (cloud.points[i].place[k] + 0.5) / 65536.0 * cloud.edge - 0.5 * cloud.edge;
  };
  EXPECT_NEAR(place(0, 0), 4.0, 1e-3);
  EXPECT_NEAR(place(0, 1), -4.0, 1e-3);
  EXPECT_NEAR(place(1, 2), 1.0, 1e-3);
  EXPECT_EQ(sensor_cloud(std::vector<Point>(1000, {.x = 1.0F}), 100).points.size(), 100U);
  EXPECT_TRUE(sensor_cloud({}, 100).points.empty());
}

TEST(LiveSceneTest, TellsAllAndThenWhatIsNew) {
  LiveScene scene("drive.mcap");
  const ViewNews begin = scene.news(0);
  ASSERT_EQ(begin.texts.size(), 3U);
  EXPECT_EQ(json::parse(*begin.texts[0]).at("live"), true);
  EXPECT_EQ(json::parse(*begin.texts[1]).at("type"), "graph");
  EXPECT_FALSE(last_of(begin).contains("newest"));
  EXPECT_TRUE(scene.news(begin.told).texts.empty());

  scene.set_doing("mapping");
  scene.add(sweep_at(0, std::nullopt, true));
  scene.add(sweep_at(1));
  const ViewNews two = scene.news(begin.told);
  ASSERT_EQ(two.texts.size(), 1U);
  const json live = last_of(two);
  EXPECT_EQ(live.at("doing"), "mapping");
  EXPECT_EQ(live.at("progress").at("sweeps"), 2);
  EXPECT_EQ(live.at("from"), 0);
  EXPECT_EQ(live.at("sweeps").at("time").dump(), "[0.0,0.1]");
  EXPECT_EQ(live.at("newest").at("pose").at(0), 1.0);
  EXPECT_EQ(live.at("clouds").at("number").dump(), "[0]");
  EXPECT_EQ(points_in(scene.tile(0)), 1U);
  EXPECT_EQ(points_in(scene.tile(live.at("newest").at("number").at(0))), 1U);
  EXPECT_EQ(points_in(scene.tile(77)), 0U);

  scene.add(sweep_at(2));
  const json third = last_of(scene.news(two.told));
  EXPECT_EQ(third.at("from"), 2);
  EXPECT_EQ(third.at("sweeps").at("time").size(), 1U);
  EXPECT_FALSE(third.contains("clouds"));
  EXPECT_EQ(last_of(scene.news(0)).at("sweeps").at("time").size(), 3U);
}

TEST(LiveSceneTest, ALongRunIsThinned) {
  LiveScene scene("drive.mcap");
  for (int i = 0; i < 20'000; ++i) {
    scene.add(sweep_at(i, std::nullopt, i % 10 == 0));
  }
  const json live = last_of(scene.news(0));
  EXPECT_EQ(live.at("sweeps").at("time").size(), 2500U);
  EXPECT_EQ(live.at("clouds").at("number").size(), 500U);
  for (const uint32_t number : live.at("clouds").at("number")) {
    ASSERT_EQ(points_in(scene.tile(number)), 1U);
  }
}

TEST(LiveSceneTest, SweepsMoveWithTheirKeyframes) {
  const test::TemporaryFolder folder;
  LiveScene scene("drive.mcap");
  for (int i = 0; i < 3; ++i) {
    scene.add(sweep_at(i, i, true));
  }
  const uint64_t told = scene.news(0).told;
  {
    MapDatabase map(folder / "map.adit", MapAccess::write);
    const SessionId session = test::add_session(map);
    map.store(test::record_of_a_point(0, session));
    map.store(test::record_of_a_point(1, session));  // 10 m ahead of the first
    LiveGraphReader reader;                          // beside the writer
    scene.set(reader.read(folder / "map.adit", scene.span()));
  }
  const ViewNews news = scene.news(told);
  ASSERT_EQ(news.texts.size(), 2U);
  EXPECT_EQ(json::parse(*news.texts[0]).at("keyframes").at("id").size(), 2U);
  const json live = last_of(news);
  EXPECT_EQ(live.at("from"), 0);
  const json& pose = live.at("sweeps").at("pose");
  EXPECT_EQ(pose.at(7), 10.0);
  EXPECT_EQ(pose.at(14), 2.0);  // its keyframe is not stored yet
  EXPECT_EQ(live.at("clouds").at("pose").at(7), 10.0);
}

}  // namespace
}  // namespace adit
