// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit inspect` compares how the sensors turn: clocks that are apart by less than a second, and
// mountings that are stated wrongly.
#include <cmath>
#include <numbers>

#include "adit/tests/tools/inspect_support.hpp"
#include "adit/tools/inspection/inspection.hpp"

namespace adit {
namespace {

using test::clean_recording;
using test::Kinds;
using test::kinds_after;
using test::MovingRig;
using test::Recorded;

nlohmann::json report(const std::vector<Recorded>& events) {
  const test::TemporaryFolder folder;
  std::ostringstream out;
  std::ostringstream err;
  InspectCommandOptions options;
  options.recording = test::write(folder, events);
  options.json = true;
  inspect_command(options, out, err);
  EXPECT_EQ(err.str(), "");
  return nlohmann::json::parse(out.str());
}

/// The recording with the IMU stated to be mounted like this.
std::vector<Recorded> told(std::vector<Recorded> events, const Eigen::Matrix3d& R_base_imu) {
  for (Recorded& event : events) {
    auto* transform = std::get_if<StaticTransform>(&event.value);
    if (transform != nullptr && transform->child == "imu") {
      transform->T_parent_child.linear() = R_base_imu;
    }
  }
  return events;
}

TEST(InspectMotion, ClocksThatAreATenthOfASecondApart) {
  for (const int late : {100, -100, 60}) {
    std::vector<Recorded> events = clean_recording();
    for (Recorded& event : events) {
      if (auto* imu = std::get_if<ImuSample>(&event.value)) {
        imu->stamp += std::chrono::milliseconds(late);
      }
    }
    const nlohmann::json found = report(events);
    ASSERT_EQ(found["findings"].size(), 1U) << found["findings"];
    EXPECT_EQ(found["findings"][0]["kind"], "sensor_offset");
    EXPECT_EQ(found["findings"][0]["topic"], "/imu");
    const nlohmann::json& motion = found["motion"][0];
    EXPECT_NEAR(motion["imu_offset_s"].get<double>(), 1e-3 * late, 0.005);
    EXPECT_LT(motion["imu_offset_sigma_s"].get<double>(), 0.005);
  }
}

TEST(InspectMotion, OffsetBesideALeap) {
  EXPECT_EQ(kinds_after([](Recorded& event) {
              if (auto* imu = std::get_if<ImuSample>(&event.value)) {
                imu->stamp += std::chrono::milliseconds(37120);
              }
            }),
            (Kinds{"clock_offset /imu", "sensor_offset /imu"}));
}

TEST(InspectMotion, MountingThatIsToldWrongly) {
  const Eigen::Matrix3d swapped = so3_exp({0.0, 0.0, std::numbers::pi / 2});
  const nlohmann::json found = report(told(clean_recording(), swapped));
  ASSERT_EQ(found["findings"].size(), 1U) << found["findings"];
  EXPECT_EQ(found["findings"][0]["kind"], "mounting");
  EXPECT_NEAR(found["motion"][0]["misalignment_rad"].get<double>(), std::numbers::pi / 2, 0.08);
}

TEST(InspectMotion, MountingThatIsToldTheWrongWayRound) {
  MovingRig rig;
  rig.T_lidar_imu.linear() = so3_exp({0.0, 0.0, 0.6});
  const std::vector<Recorded> events = rig.record();
  const nlohmann::json found = report(told(events, rig.T_lidar_imu.linear().transpose()));
  ASSERT_EQ(found["findings"].size(), 1U) << found["findings"];
  const std::string text = found["findings"][0]["found"];
  EXPECT_NE(text.find("the wrong way round"), std::string::npos) << text;
}

TEST(InspectMotion, MountingIsToldWhereNoTransformIs) {
  MovingRig rig;
  rig.T_lidar_imu.linear() = so3_exp({0.5, -0.4, 1.9});
  std::vector<Recorded> events = rig.record();
  std::erase_if(events, [](const Recorded& event) { return event.topic == "/tf_static"; });
  const nlohmann::json found = report(events);
  ASSERT_EQ(found["findings"].size(), 1U) << found["findings"];
  EXPECT_EQ(found["findings"][0]["kind"], "mounting_unknown");
  const std::vector<double> q = found["motion"][0]["R_range_imu_xyzw"];
  const Eigen::Quaterniond R(q[3], q[0], q[1], q[2]);
  EXPECT_LT(R.angularDistance(Eigen::Quaterniond(rig.T_lidar_imu.linear())), 0.08);
  EXPECT_TRUE(found["motion"][0]["misalignment_rad"].is_null());
}

TEST(InspectMotion, WithoutTurningNothingIsSaid) {
  MovingRig rig;
  rig.sway = 0.0;
  const nlohmann::json found = report(rig.record());
  EXPECT_EQ(found["findings"].size(), 0U) << found["findings"];
  EXPECT_FALSE(found["motion"][0].contains("imu_offset_s"));
}

TEST(InspectMotion, KeepsHowBothTurnedFromSweepToSweep) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  for (Recorded& event : events) {
    if (auto* imu = std::get_if<ImuSample>(&event.value)) {
      imu->stamp += std::chrono::milliseconds(60);
      imu->angular_velocity += Eigen::Vector3d(0.1, 0.0, -0.1);
    }
  }
  const Inspection inspection = inspect({test::write(folder, events)}, {}, {});
  ASSERT_EQ(inspection.motion.size(), 1U);
  const MotionCheck& check = inspection.motion[0];
  EXPECT_EQ(check.mapped.size(), check.sweeps);
  EXPECT_EQ(check.mapped.back().state, "tracking");
  EXPECT_NE(check.mapped.back().translation[0].localizability, "");
  ASSERT_GT(check.turns.size(), 45U);
  double turned = 0.0;
  double apart = 0.0;
  for (const ComparedTurn& turn : check.turns) {
    EXPECT_NEAR(turn.duration, 0.1, 0.02);
    turned += turn.range.squaredNorm();
    apart += (turn.gyroscope - turn.range).squaredNorm();
  }
  EXPECT_LT(apart, 0.02 * turned) << "without the offset and the bias they are the same turns";
}

}  // namespace
}  // namespace adit
