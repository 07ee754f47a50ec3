// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/run_sources.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace adit {
namespace {

std::vector<SourceWorth> four_sources() {
  return {{.name = "lidar",
           .unit = "sweeps",
           .used = 120,
           .innovation_squared = 0.6,
           .shares = {{"along", 0.353}, {"up", 0.349}}},
          {.name = "imu",
           .unit = "sweeps",
           .used = 113,
           .left_out = 7,
           .shares = {{"along", 0.574}, {"up", 0.651}}},
          {.name = "velocity",
           .topic = "/wheels",
           .unit = "sweeps",
           .used = 108,
           .refused = 3,
           .remark = "it deviates",
           .shares = {{"along", 0.073}, {"up", 0.0}}},
          {.name = "gnss",
           .estimate = SourceEstimate::map,
           .unit = "fixes",
           .used = 4,
           .shares = {{"level", 1.0}}}};
}

TEST(RunSources, AreReadAsTheyWereWritten) {
  const auto json = to_json(four_sources());
  EXPECT_EQ(to_json(sources_of(nlohmann::ordered_json::parse(json.dump()))), json);
  EXPECT_TRUE(json[0]["topic"].is_null());
  EXPECT_EQ(json[2]["topic"], "/wheels");
  EXPECT_TRUE(json[1]["innovation_squared_per_degree"].is_null());
}

TEST(RunSources, WhatIsNoListOfSourcesHasNone) {
  using nlohmann::ordered_json;
  EXPECT_TRUE(sources_of(ordered_json()).empty());
  EXPECT_TRUE(sources_of(ordered_json::parse(R"({"name": "lidar"})")).empty());
  EXPECT_TRUE(sources_of(ordered_json::parse(R"([1, "lidar", null])")).empty());
  const auto odd = sources_of(ordered_json::parse(
      R"([{"name": 5, "used": -3, "refused": "many", "shares": [1], "topic": {}}])"));
  ASSERT_EQ(odd.size(), 1U);
  EXPECT_EQ(odd[0].name, "");
  EXPECT_EQ(odd[0].used, 0U);
  EXPECT_TRUE(odd[0].shares.empty());
}

TEST(RunSources, TheTableHasARowForEach) {
  const std::string text = describe(four_sources(), 4);
  EXPECT_NE(text.find("of the motion"), std::string::npos) << text;
  EXPECT_NE(text.find("    of the map"), std::string::npos) << text;
  EXPECT_NE(text.find("    velocity /wheels"), std::string::npos) << text;
  EXPECT_NE(text.find("it deviates"), std::string::npos) << text;
  EXPECT_NE(text.find("35 %"), std::string::npos) << text;
  EXPECT_EQ(describe(std::vector<SourceWorth>(), 4), "");
}

TEST(RunSources, OneLineSaysWhoDecides) {
  EXPECT_EQ(describe_shares(four_sources()),
            "motion along the path: imu 57 %, lidar 35 %, velocity 7 %; position in the map: gnss "
            "100 %");
  std::vector<SourceWorth> usual = four_sources();
  usual.resize(2);
  EXPECT_EQ(describe_shares(usual), "") << "lidar and IMU alone are no news";
}

}  // namespace
}  // namespace adit
