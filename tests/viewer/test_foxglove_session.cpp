// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/foxglove_session.hpp"

#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/protobuf_fields.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/viewer/foxglove_cloud_feed.hpp"
#include "adit/tools/viewer/foxglove_live_feed.hpp"
#include "adit/tools/viewer/foxglove_run_feed.hpp"

namespace adit {
namespace {

using nlohmann::json;

/// Messages are "topic position".
class ListedFeed final : public FoxgloveFeed {
 public:
  struct Listed {
    std::string topic;
    std::set<uint64_t> positions;
  };

  explicit ListedFeed(std::vector<Listed> listed) : listed_(std::move(listed)) {
    for (const Listed& one : listed_) {
      channels_.push_back({.topic = one.topic,
                           .schema = {.name = "a.Type",
                                      .encoding = "protobuf",
                                      .data = "abc",
                                      .message_encoding = "protobuf"}});
    }
  }
  const std::vector<FoxgloveChannel>& channels() const override { return channels_; }
  std::optional<uint64_t> next(std::size_t channel, uint64_t after) override {
    const std::set<uint64_t>& positions = listed_[channel].positions;
    const auto found = positions.upper_bound(after);
    return found == positions.end() ? std::nullopt : std::optional(*found);
  }
  FoxgloveMessage message(std::size_t channel, uint64_t position) override {
    if (damaged) {
      throw InputError("map.adit", {}, "it is damaged", "Map again");
    }
    return {.stamp = Nanoseconds(1000 * static_cast<int64_t>(position)),
            .content = std::make_shared<const std::string>(listed_[channel].topic + " " +
                                                           std::to_string(position))};
  }

  bool damaged = false;

 private:
  std::vector<Listed> listed_;
  std::vector<FoxgloveChannel> channels_;
};

struct Talk {
  std::shared_ptr<ListedFeed> feed =
      std::make_shared<ListedFeed>(std::vector<ListedFeed::Listed>{{"/a", {1, 3}}, {"/b", {2, 3}}});
  FoxgloveSession session{[this] { return feed; }, "run 1"};

  json text() {
    const auto frame = session.next();
    return frame && frame->is_text ? json::parse(frame->head) : json();
  }
  /// "subscription: message", or empty where there is none.
  std::string data() {
    const auto frame = session.next();
    if (!frame || frame->is_text) {
      return {};
    }
    EXPECT_EQ(frame->head.size(), 13U);
    EXPECT_EQ(frame->head[0], 1);
    uint32_t subscription = 0;
    uint64_t stamp = 0;
    std::memcpy(&subscription, frame->head.data() + 1, 4);
    std::memcpy(&stamp, frame->head.data() + 5, 8);
    EXPECT_EQ(*frame->content, frame->content->substr(0, 3) + std::to_string(stamp / 1000));
    return std::to_string(subscription) + ": " + *frame->content;
  }
  ViewTaken subscribe(uint32_t id, uint32_t channel) {
    return session.take(
        json({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}})
            .dump(),
        true);
  }
};

TEST(FoxgloveSession, ChoosesAProtocolThatItKnows) {
  EXPECT_EQ(foxglove_protocol_of("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(foxglove_protocol_of("foxglove.sdk.v1, foxglove.websocket.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(foxglove_protocol_of("other ,\t foxglove.sdk.v1 "), "foxglove.sdk.v1");
  for (const char* none : {"", ",", " ", "foxglove.sdk.v2", "foxglove.sdk.v1x", "foxglove"}) {
    EXPECT_EQ(foxglove_protocol_of(none), "") << none;
  }
}

TEST(FoxgloveSession, BeginsWithWhatThereIs) {
  Talk talk;
  const json info = talk.text();
  EXPECT_EQ(info.at("op"), "serverInfo");
  EXPECT_EQ(info.at("capabilities"), json::array());
  EXPECT_EQ(info.at("sessionId"), "run 1");
  EXPECT_EQ(talk.text().at("channels")[1], json::parse(R"({"id": 1, "topic": "/b",
      "encoding": "protobuf", "schemaName": "a.Type", "schema": "YWJj",
      "schemaEncoding": "protobuf"})"));
  EXPECT_FALSE(talk.session.next()) << "nothing is subscribed to";
}

TEST(FoxgloveSession, SendsWhatIsSubscribedToInTheFeedsOrder) {
  Talk talk;
  talk.text();
  talk.text();
  talk.subscribe(70'000, 1);
  talk.subscribe(5, 0);
  for (const char* message : {"5: /a 1", "70000: /b 2", "5: /a 3", "70000: /b 3", ""}) {
    EXPECT_EQ(talk.data(), message);
  }
  EXPECT_TRUE(talk.session.take(R"({"op": "unsubscribe", "subscriptionIds": [5]})", true).goes_on);
  talk.subscribe(6, 0);  // from the beginning
  EXPECT_EQ(talk.data(), "6: /a 1");
}

TEST(FoxgloveSession, AnotherFeedIsToldFromItsBeginning) {
  Talk talk;
  talk.text();
  talk.text();
  talk.subscribe(1, 0);
  talk.subscribe(2, 1);
  EXPECT_EQ(talk.data(), "1: /a 1");
  talk.feed =
      std::make_shared<ListedFeed>(std::vector<ListedFeed::Listed>{{"/c", {1}}, {"/b", {1, 4}}});
  EXPECT_EQ(talk.text(), json::parse(R"({"op": "unadvertise", "channelIds": [0]})"));
  const json added = talk.text();
  ASSERT_EQ(added.at("channels").size(), 1U);
  EXPECT_EQ(added.at("channels")[0].at("id"), 2) << "no number is used twice";
  for (const char* message : {"2: /b 1", "2: /b 4", ""}) {
    EXPECT_EQ(talk.data(), message);
  }
  EXPECT_EQ(talk.subscribe(9, 0).refused, ViewRefusal::not_offered);
  talk.feed = std::make_shared<ListedFeed>(std::vector<ListedFeed::Listed>{{"/a", {7}}});
  EXPECT_EQ(talk.text().at("op"), "status");
  EXPECT_EQ(talk.text(), json::parse(R"({"op": "unadvertise", "channelIds": [1, 2]})"));
  EXPECT_EQ(talk.text().at("channels")[0].at("id"), 0) << "the same topic as before";
}

TEST(FoxgloveSession, TellsOfADamagedMapAndStopsThere) {
  Talk talk;
  talk.text();
  talk.text();
  talk.subscribe(1, 0);
  talk.feed->damaged = true;
  const json told = talk.text();
  EXPECT_EQ(told.at("op"), "status");
  EXPECT_EQ(told.at("level"), 2);
  EXPECT_NE(told.at("message").get<std::string>().find("it is damaged"), std::string::npos);
  EXPECT_FALSE(talk.session.next());
}

TEST(FoxgloveSession, AnswersOfOneWhoTakesNoneAreBounded) {
  Talk talk;
  int answered = 0;
  while (answered < 1000 && talk.session.take(R"({"op": "nothing"})", true).goes_on) {
    ++answered;
  }
  EXPECT_GT(answered, 10);
  EXPECT_LT(answered, 100);
  EXPECT_EQ(talk.session.take(R"({"op": "nothing"})", true).refused, ViewRefusal::too_many);
}

LiveSweep live_sweep(int i) {
  const std::vector<Point> points = {{.x = 2.0F}, {.y = 1.0F}};
  LiveSweep sweep{.stamp = Nanoseconds(1'000'000'000LL * (i + 1)),
                  .keyframe = 0,
                  .points = sensor_cloud(points, 10)};
  sweep.T_map_lidar.translation().x() = i;
  sweep.T_first_lidar.translation().x() = i;
  if (i % 4 == 0) {
    sweep.keyframe_cloud = sensor_cloud(points, 10);
  }
  return sweep;
}

std::size_t channel_of(const FoxgloveFeed& feed, const std::string& topic) {
  const auto& channels = feed.channels();
  return static_cast<std::size_t>(std::ranges::find(channels, topic, &FoxgloveChannel::topic) -
                                  channels.begin());
}

std::vector<uint64_t> positions_of(FoxgloveFeed& feed, const std::string& topic) {
  const std::size_t channel = channel_of(feed, topic);
  std::vector<uint64_t> positions;
  while (const auto next = feed.next(channel, positions.empty() ? 0 : positions.back())) {
    positions.push_back(*next);
  }
  return positions;
}

test::ProtobufFields last_of(FoxgloveFeed& feed, const std::string& topic) {
  return test::ProtobufFields(
      *feed.message(channel_of(feed, topic), positions_of(feed, topic).back()).content);
}

/// x of the points of a cloud.
std::vector<float> x_of(const test::ProtobufFields& cloud) {
  const std::string data = cloud.text(6);
  std::vector<float> x(data.size() / sizeof(Point));
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::memcpy(&x[i], data.data() + i * sizeof(Point), sizeof(float));
  }
  return x;
}

TEST(FoxgloveLiveFeedTest, KeepsTheNewestSweepsAndAllKeyframes) {
  LiveScene scene("drive.mcap");
  FoxgloveLiveFeed feed(scene);
  EXPECT_TRUE(positions_of(feed, "/tf").empty());
  EXPECT_TRUE(positions_of(feed, "/map/points").empty());
  EXPECT_TRUE(positions_of(feed, "/graph/trajectory").empty());
  EXPECT_TRUE(positions_of(feed, "/graph/loops").empty());
  for (int i = 0; i < 12; ++i) {
    scene.add(live_sweep(i));
  }
  EXPECT_EQ(positions_of(feed, "/tf").size(), 8U) << "a slow client misses the others";
  EXPECT_EQ(positions_of(feed, "/tf"), positions_of(feed, "/lidar/points"));
  EXPECT_EQ(positions_of(feed, "/keyframe/points").size(), 3U);
  EXPECT_EQ(positions_of(feed, "/map/points").size(), 1U) << "as a whole, once";
  EXPECT_EQ(positions_of(feed, "/graph/trajectory").size(), 1U);
  const auto transform = last_of(feed, "/tf");
  EXPECT_EQ(transform.part(1).integer(1), 12);
  EXPECT_EQ(transform.part(4).real(1), 11.0);
  const auto sweep = last_of(feed, "/lidar/points");
  EXPECT_EQ(sweep.text(2), "lidar");
  EXPECT_NEAR(x_of(sweep)[0], 2.0F, 1e-3F);
  EXPECT_EQ(sweep.count(5), 3U) << "x, y, z: no intensity is known";
  EXPECT_NEAR(x_of(last_of(feed, "/keyframe/points"))[0], 10.0F, 1e-3F);
}

TEST(FoxgloveLiveFeedTest, WhatMovesIsDrawnAnew) {
  LiveScene scene("drive.mcap");
  FoxgloveLiveFeed feed(scene);
  for (int i = 0; i < 5; ++i) {
    scene.add(live_sweep(i));
  }
  const auto before = positions_of(feed, "/map/points");
  const auto drawn = positions_of(feed, "/graph/trajectory");
  LiveGraph graph{.json = "{}", .parts = {{.topic = kLoopsTopic, .entity = {.id = "loops"}}}};
  graph.T_map_first.emplace(0, Eigen::Isometry3d(Eigen::Translation3d(100.0, 0.0, 0.0)));
  scene.set(graph);
  EXPECT_GT(positions_of(feed, "/map/points").back(), before.back());
  const std::size_t map = channel_of(feed, "/map/points");
  const uint64_t now = positions_of(feed, "/map/points").back();
  EXPECT_EQ(feed.message(map, now).content, feed.message(map, now).content) << "made once for all";
  EXPECT_GT(positions_of(feed, "/graph/trajectory").back(), drawn.back());
  EXPECT_EQ(positions_of(feed, "/graph/loops").size(), 1U);
  const std::vector<float> x = x_of(last_of(feed, "/map/points"));
  ASSERT_EQ(x.size(), 4U);
  EXPECT_NEAR(x[0], 102.0F, 1e-3F);
  EXPECT_NEAR(x[2], 106.0F, 1e-3F);
}

TEST(FoxgloveRunFeedTest, TheOverviewComesOnceItIsMade) {
  const test::TemporaryFolder folder;
  {
    MapDatabase map(folder / "map.adit", MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 3; ++id) {
      map.store(test::record_of_a_point(id, session));
    }
  }
  FoxgloveRunFeed feed(folder / "map.adit");
  EXPECT_EQ(positions_of(feed, "/keyframe/points").size(), 3U);
  const std::size_t channel = channel_of(feed, "/map/points");
  std::optional<uint64_t> position = feed.next(channel, 0);
  while (!position) {  // it is made on a thread of its own
    std::this_thread::yield();
    position = feed.next(channel, 0);
  }
  EXPECT_EQ(x_of(last_of(feed, "/map/points")).size(), 3U);
  EXPECT_EQ(feed.message(channel, *position).content, feed.message(channel, *position).content);
  EXPECT_FALSE(feed.next(channel, *position)) << "it comes once";
}

TEST(FoxgloveCloudFeedTest, HasAsManyLevelsAsFit) {
  constexpr int kEdge = 200;
  constexpr double kStep = 0.02;  // m: some tens of points to a cell of the first level
  CloudTilesMaker maker({.low = Eigen::Vector3d(-8.0, -8.0, -8.0), .edge = 16.0});
  for (int i = 0; i < kEdge * kEdge; ++i) {
    maker.add({-2.0 + kStep * (i % kEdge), 3.0 + kStep * (i / kEdge), 1.0}, {.intensity = 7});
  }
  const CloudTiles tiles = maker.make();
  const std::vector<Point> all = points_of_tiles(tiles, kEdge * kEdge);
  std::set<std::pair<int, int>> found;
  for (const Point& point : all) {
    const double x = (point.x + 2.0) / kStep;
    const double y = (point.y - 3.0) / kStep;
    EXPECT_NEAR(x, std::round(x), 0.01);
    EXPECT_NEAR(y, std::round(y), 0.01);
    EXPECT_NEAR(point.z, 1.0F, 2e-4F);
    EXPECT_EQ(point.intensity, 7.0F);
    found.emplace(std::lround(x), std::lround(y));
  }
  EXPECT_EQ(all.size(), std::size_t{kEdge * kEdge});
  EXPECT_EQ(found.size(), all.size());
  const std::size_t first = tiles.tiles().front().points;
  const std::vector<Point> some = points_of_tiles(tiles, kEdge * kEdge - 1);
  EXPECT_LT(some.size(), all.size());
  EXPECT_GE(some.size(), first);
  EXPECT_EQ(points_of_tiles(tiles, 0).size(), first);
}

}  // namespace
}  // namespace adit
