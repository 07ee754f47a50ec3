// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/gnss_text.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

GnssReport report(std::size_t fixes, FixVerdict verdict) {
  GnssReport gnss{.fixes = fixes};
  gnss.verdicts[static_cast<std::size_t>(verdict)] = fixes;
  return gnss;
}

Georeference north_west() {
  Georeference world{.origin = {.latitude = 41.65, .longitude = -0.88, .altitude = 200.0},
                     .T_world_map = Eigen::Isometry3d::Identity(),
                     .covariance = Matrix6d::Zero()};
  // The map's x axis points north-west: 315 degrees from north.
  world.T_world_map.linear() =
      Eigen::AngleAxisd(0.75 * 3.14159265358979, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  world.covariance(5, 5) = 1e-6;
  return world;
}

TEST(GnssText, SaysWhereTheMapLies) {
  GnssReport gnss = report(40, FixVerdict::used);
  gnss.georeference = north_west();
  gnss.horizontal = 0.012;
  gnss.vertical = 0.034;
  gnss.heights = 40;
  const std::string text = describe(gnss);
  for (const std::string_view part :
       {"40 of 40 fixes used", "0.012 m level", "0.034 m in height", "315.00 degrees (+- 0.06)",
        "41.6500000, -0.8800000, 200.00 m"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  }
  const auto json = to_json(gnss);
  EXPECT_EQ(json["verdicts"]["used"], 40);
  EXPECT_NEAR(json["georeference"]["heading_deg"], 315.0, 1e-6);
  EXPECT_EQ(json["residual_vertical_m"], 0.034);
  EXPECT_FALSE(json.contains("why_not"));
  gnss.heights = 0;
  EXPECT_NE(describe(gnss).find("no fix that was used has an altitude"), std::string::npos)
      << describe(gnss);
  EXPECT_TRUE(to_json(gnss)["residual_vertical_m"].is_null());
}

TEST(GnssText, SaysWhereTheAntennaReallySitsAndHowLateItsFixesAre) {
  GnssReport gnss = report(40, FixVerdict::used);
  gnss.georeference = north_west();
  EXPECT_EQ(describe_antenna(gnss), "") << "nothing is known";
  EXPECT_FALSE(to_json(gnss).contains("antenna"));

  const AntennaParameter no{.value = 0.01, .sigma = 0.02, .observable = true};
  const AntennaParameter unknown{.value = 70.0, .sigma = 300.0};
  const AntennaParameter ahead{
      .value = 0.42, .sigma = 0.04, .observable = true, .significant = true};
  const AntennaParameter late{
      .value = 0.12, .sigma = 0.01, .observable = true, .significant = true};
  gnss.antenna = AntennaReport{.estimated = true, .parameters = {no, no, unknown, no}};
  EXPECT_NE(describe_antenna(gnss).find("x 0.01 m (+- 0.02), y 0.01 m (+- 0.02), z not observable"),
            std::string::npos)
      << describe_antenna(gnss);
  EXPECT_TRUE(to_json(gnss)["antenna"]["z_m"]["error"].is_null());
  EXPECT_EQ(to_json(gnss)["antenna"]["x_m"]["sigma"], 0.02);

  gnss.antenna = AntennaReport{.estimated = true,
                               .parameters = {ahead, no, unknown, late},
                               .corrected = true,
                               .cost_before = 176.2,
                               .cost_after = 74.1,
                               .p_lidar_antenna = {0.22, 0.05, 0.35},
                               .time_offset = -0.12};
  for (const std::string_view part :
       {"0.42 m (+- 0.04) along the lidar's x", "0.120 s (+- 0.010) late",
        "gnss.antenna = [0.22, 0.05, 0.35]", "gnss.time_offset = -0.120",
        "chi squared 74, it was 176", "z not observable"}) {
    EXPECT_NE(describe_antenna(gnss).find(part), std::string::npos)
        << part << " in: " << describe_antenna(gnss);
  }
  EXPECT_EQ(to_json(gnss)["antenna"]["delay_s"]["significant"], true);
  EXPECT_EQ(to_json(gnss)["antenna"]["text"], describe_antenna(gnss));

  gnss.antenna.corrected = false;
  EXPECT_NE(describe_antenna(gnss).find("left as it is"), std::string::npos);
}

TEST(GnssText, SaysWhyAMapHasNoPlaceAndWhatToDo) {
  GnssReport swapped = report(30, FixVerdict::waiting);
  swapped.swapped = true;
  GnssReport late;
  late.outside = 30;
  GnssReport blind;
  blind.without_position = 30;
  GnssReport unrelated = report(30, FixVerdict::waiting);
  unrelated.extent = 50.0;
  GnssReport little = report(6, FixVerdict::waiting);
  little.yaw_sigma = 0.1;
  GnssReport jumping = report(121, FixVerdict::waiting);
  jumping.jump = ReceiverJump{.time = 30.5, .distance = 50.0, .before = 60, .after = 61};
  GnssReport unclear = report(90, FixVerdict::waiting);
  unclear.yaw_sigma = 0.001;
  unclear.asked = 90;
  unclear.agreeing = 20;
  GnssReport no_numbers;
  no_numbers.left_out = 30;
  for (const auto& [gnss, why] :
       {std::pair(swapped, "latitude and longitude exchanged"), std::pair(late, "gnss.time_offset"),
        std::pair(blind, "30 without a position"), std::pair(blind, "had no position"),
        std::pair(report(30, FixVerdict::impossible), "a position on the Earth"),
        std::pair(unrelated, "do not move as the map does"), std::pair(little, "a longer path"),
        std::pair(jumping, "two places"),
        std::pair(jumping, "jumps by 50.0 m, 30.5 s after its first fix: 60 fixes before and 61"),
        std::pair(unclear, "only 20 of 90 fixes agree"), std::pair(no_numbers, "30 not finite")}) {
    EXPECT_NE(describe(gnss).find(why), std::string::npos) << describe(gnss);
    EXPECT_TRUE(to_json(gnss)["georeference"].is_null());
    EXPECT_FALSE(to_json(gnss)["why_not"].get<std::string>().empty());
  }
}

}  // namespace
}  // namespace adit
