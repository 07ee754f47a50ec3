// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/live_scene.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_database/map_database.hpp"

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

TEST(SensorCloudTest, HasIntensitiesWhereTheBrightestIsKnown) {
  const std::vector<Point> points = {{.x = 1.0F, .intensity = 20.0F},
                                     {.x = 1.0F, .intensity = 90.0F}};
  const SensorCloud cloud = sensor_cloud(points, 10, 40.0F);
  EXPECT_EQ(cloud.points[0].facts.intensity, 127);
  EXPECT_EQ(cloud.points[1].facts.intensity, 255);
  EXPECT_EQ(sensor_cloud(points, 10).points[1].facts.intensity, 0);
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
  EXPECT_EQ(live.at("clouds").at("time").dump(), "[0.0]");
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

TEST(LiveSceneTest, PlotsGrowWithTheSweeps) {
  LiveScene scene("drive.mcap");
  const ViewNews begin = scene.news(0);
  const json plots = json::parse(*begin.texts[0]).at("plots");
  ASSERT_EQ(plots.at("curves").size(), kPlotCurves);
  EXPECT_EQ(plots.at("curves").at(0).at("name"), "overlap");
  EXPECT_FALSE(last_of(begin).contains("plots")) << "no sweep has come";
  EXPECT_TRUE(last_of(begin).at("stretches").empty());

  const std::array<double, 3> overlaps = {0.9, 0.8, 0.7};
  for (int i = 0; i < 2; ++i) {
    LiveSweep sweep = sweep_at(i);
    sweep.record.overlap = overlaps[static_cast<std::size_t>(i)];
    scene.add(std::move(sweep));
  }
  const ViewNews two = scene.news(begin.told);
  const json both = last_of(two).at("plots");
  EXPECT_EQ(both.at("from"), 0);
  EXPECT_DOUBLE_EQ(both.at("step").get<double>(), 0.1);
  EXPECT_EQ(both.at("least").at(0).dump(), "[0.9,0.8]");
  EXPECT_EQ(both.at("most").at(1).dump(), "[null,null]") << "nothing is known of it";

  LiveSweep third = sweep_at(2);
  third.record.overlap = overlaps[2];
  third.progress.stretches = {{.state = "doubtful",
                               .begin = Nanoseconds(1'100'000'000),
                               .end = third.stamp,
                               .text = "why"}};
  scene.add(third);
  const ViewNews three = scene.news(two.told);
  EXPECT_EQ(last_of(three).at("plots").at("from"), 2);
  EXPECT_EQ(last_of(three).at("plots").at("least").at(0).dump(), "[0.7]");
  EXPECT_EQ(last_of(three).at("stretches").dump(),
            R"([{"begin":0.1,"end":0.2,"state":"doubtful","text":"why"}])");
  LiveSweep fourth = sweep_at(3);
  fourth.progress.stretches = third.progress.stretches;
  scene.add(std::move(fourth));
  EXPECT_FALSE(last_of(scene.news(three.told)).contains("stretches")) << "they are as they were";
  EXPECT_EQ(last_of(scene.news(0)).at("plots").at("least").at(0).size(), 4U)
      << "who comes back gets all of it";
}

TEST(LivePlotsTest, LongRunsKeepTheirExtremes) {
  LivePlots plots;
  constexpr int kSweeps = 5000;
  for (int i = 0; i < kSweeps; ++i) {
    SweepRecord sweep;
    sweep.overlap = i == 2500 ? 0.1 : 0.9;
    plots.add(sweep, 0.1 * i, static_cast<uint64_t>(i) + 1);
  }
  const json all = json::parse(plots.since(0).dump());
  const auto least = all.at("least").at(0).get<std::vector<double>>();
  EXPECT_LE(least.size(), kMostPlotBins);
  EXPECT_GT(least.size(), kMostPlotBins / 2);
  EXPECT_DOUBLE_EQ(all.at("step").get<double>(), 0.8);
  const auto at = static_cast<std::size_t>((250.0 - all.at("begin").get<double>()) / 0.8);
  EXPECT_EQ(least[at], 0.1);
  EXPECT_EQ(std::ranges::count(least, 0.1), 1);
  EXPECT_EQ(all.at("most").at(0).at(at), 0.9);
  EXPECT_EQ(plots.since(kSweeps - 1).at("least").at(0).size(), 1U);
  EXPECT_TRUE(plots.since(kSweeps).is_null());
}

TEST(LivePlotsTest, AHoleOfDaysIsNoMemory) {
  LivePlots plots;
  SweepRecord sweep;
  sweep.overlap = 0.5;
  for (const double seconds : {0.0, 0.1, 1e7, 1e7 + 0.1}) {
    plots.add(sweep, seconds, 1);
  }
  const auto all = plots.since(0);
  EXPECT_LE(all.at("least").at(0).size(), kMostPlotBins);
  EXPECT_EQ(all.at("least").at(0).back(), 0.5);
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
