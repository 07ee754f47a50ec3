// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit inspect` says of topics of velocities.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/tools/inspect_support.hpp"

namespace adit {
namespace {

using test::clean_recording;
using test::Kinds;
using test::kinds;
using test::MovingRig;
using test::Recorded;

namespace fs = std::filesystem;

/// The clean recording with wheels at 50 Hz, as `change` leaves them.
std::vector<Recorded> with_wheels(const std::function<void(BodyVelocity&)>& change = {}) {
  std::vector<Recorded> events = clean_recording();
  for (int i = 0; i < 300; ++i) {
    const Nanoseconds stamp = MovingRig::kBegin + std::chrono::milliseconds(20 * i);
    BodyVelocity wheels{.stamp = stamp,
                        .linear = {i % 2 == 0 ? 1.0 : 2.0, 0.0, 0.0},
                        .covariance = 0.01 * Eigen::Matrix3d::Identity(),
                        .frame = "wheels"};
    if (change) {
      change(wheels);
    }
    events.push_back({"/wheels", stamp + std::chrono::milliseconds(1), wheels});
  }
  std::ranges::stable_sort(events, {}, &Recorded::received);
  return events;
}

std::string report_of(const fs::path& file, const ConfigSource& config, bool json = false) {
  std::ostringstream out;
  std::ostringstream err;
  InspectCommandOptions options;
  options.recording = file;
  options.config = config;
  options.json = json;
  inspect_command(options, out, err);
  EXPECT_EQ(err.str(), "");
  return out.str();
}

const ConfigSource kUsed{
    .file = {}, .overrides = {"recording.velocity_topic=\"/wheels\""}, .preset = {}};

TEST(InspectVelocities, HealthyOnesAreListedWithTheSettingThatUsesThem) {
  const test::TemporaryFolder folder;
  const fs::path file = test::write(folder, with_wheels());
  EXPECT_EQ(kinds(file), Kinds{});
  EXPECT_EQ(kinds(file, kUsed), Kinds{});
  const std::string unused = report_of(file, {});
  EXPECT_NE(unused.find("geometry_msgs/TwistWithCovarianceStamped  velocities       300     50.00"),
            std::string::npos)
      << unused;
  EXPECT_NE(unused.find("/wheels: velocities of the frame 'wheels', 1.50 m/s on average (at most "
                        "2.00); a run does not use them, since such messages may be commands; to "
                        "fuse it with the IMU: --set recording.velocity_topic=/wheels"),
            std::string::npos)
      << unused;
  const std::string used = report_of(file, kUsed);
  EXPECT_NE(used.find("(at most 2.00); a run fuses them with the IMU"), std::string::npos) << used;
  const nlohmann::json json = nlohmann::json::parse(report_of(file, {}, true));
  const auto& topics = json["topics"];
  const auto wheels = std::ranges::find_if(
      topics, [](const nlohmann::json& topic) { return topic["name"] == "/wheels"; });
  ASSERT_NE(wheels, topics.end());
  EXPECT_EQ((*wheels)["kind"], "velocities");
  EXPECT_DOUBLE_EQ((*wheels)["speed_m_s"]["max"], 2.0);
  EXPECT_EQ((*wheels)["without_covariance"], 0);
}

TEST(InspectVelocities, TheTwistOfOdometryIsOffered) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events = clean_recording();
  for (int i = 0; i < 60; ++i) {
    const Nanoseconds stamp = MovingRig::kBegin + std::chrono::milliseconds(100 * i);
    events.push_back({"/odom", stamp + std::chrono::milliseconds(1),
                      ReferencePose{stamp, "odom", "base",
                                    Eigen::Isometry3d(Eigen::Translation3d(0.1 * i, 0.0, 0.0))}});
  }
  std::ranges::stable_sort(events, {}, &Recorded::received);
  const fs::path file = test::write(folder, events);
  const std::string report = report_of(file, {});
  EXPECT_NE(report.find("/odom: its twist is a velocity; to fuse it with the IMU: --set "
                        "recording.velocity_topic=/odom"),
            std::string::npos)
      << report;
  // Its pose is written without a twist.
  const ConfigSource used{
      .file = {}, .overrides = {"recording.velocity_topic=\"/odom\""}, .preset = {}};
  EXPECT_EQ(kinds(file, used), (Kinds{"velocities_zero /odom", "no_covariance /odom"}));
  ConfigSource by_poses = used;
  by_poses.overrides.emplace_back("recording.velocity_of_poses=true");
  const std::string of_poses = report_of(file, by_poses);
  EXPECT_NE(of_poses.find("/odom: velocities of the frame 'base', 1.00 m/s on average (at most "),
            std::string::npos)
      << of_poses;
}

TEST(InspectVelocities, FaultsAreFoundAndDoNoHarmWhereTheyAreNotUsed) {
  const test::TemporaryFolder folder;
  const fs::path no_numbers =
      test::write(folder, with_wheels([](BodyVelocity& wheels) {
                    wheels.linear.setConstant(std::numeric_limits<double>::quiet_NaN());
                  }));
  const std::string report = report_of(no_numbers, {});
  EXPECT_NE(report.find("300 of 300 velocities have no finite number"), std::string::npos)
      << report;
  EXPECT_NE(report.find("none, a run does not use the topic"), std::string::npos) << report;
  EXPECT_EQ(kinds(no_numbers, kUsed), Kinds{"not_finite /wheels"});
  const fs::path zero = test::write(folder, with_wheels([](BodyVelocity& wheels) {
                                      wheels.linear.setZero();
                                      wheels.covariance.reset();
                                    }));
  EXPECT_EQ(kinds(zero, kUsed), (Kinds{"velocities_zero /wheels", "no_covariance /wheels"}));
}

}  // namespace
}  // namespace adit
