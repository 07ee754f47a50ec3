// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit inspect` says of topics, frames and transforms that a run does not use.
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/tools/inspect_support.hpp"

namespace adit {
namespace {

using test::clean_recording;
using test::Kinds;
using test::kinds;
using test::MovingRig;
using test::Recorded;
using test::write;

constexpr Nanoseconds kFirstStamp = MovingRig::kBegin;

std::string text_of(const std::filesystem::path& file, int expected_code) {
  std::ostringstream out;
  std::ostringstream err;
  InspectCommandOptions options;
  options.recording = file;
  EXPECT_EQ(inspect_command(options, out, err), expected_code) << out.str();
  return out.str();
}

/// The clean recording with another transform first.
std::vector<Recorded> with_transform(const char* parent, const char* child, double yaw) {
  std::vector<Recorded> events = clean_recording();
  StaticTransform transform{parent, child, Eigen::Isometry3d::Identity()};
  transform.T_parent_child.linear() = so3_exp({0.0, 0.0, yaw});
  events.insert(events.begin(), {"/tf_static", kFirstStamp, transform});
  return events;
}

TEST(InspectChoices, AnImuOfZerosIsPassedOverAndItsFaultsAreNoProblem) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events;
  for (const Recorded& event : clean_recording()) {
    if (const auto* sample = std::get_if<ImuSample>(&event.value)) {
      events.push_back(
          {"/aaa", event.received,
           ImuSample{sample->stamp, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}});
    }
    events.push_back(event);
  }
  const auto file = write(folder, events);
  EXPECT_EQ(std::ranges::count(kinds(file), "topic_passed_over /aaa"), 1);
  EXPECT_NE(text_of(file, 0).find("notice: /aaa: its first 400 readings are all zero"),
            std::string::npos)
      << text_of(file, 0);
}

TEST(InspectChoices, TransformsThatMakeNoTreeAreNamedAndTheOthersUsed) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(kinds(write(folder, with_transform("lidar", "lidar", 0.0))),
            Kinds{"transform_ignored"});
  EXPECT_EQ(kinds(write(folder, with_transform("/imu", "imu", 0.0))), Kinds{"transform_ignored"});
  EXPECT_EQ(kinds(write(folder, with_transform("map", "lidar", 1.0))), Kinds{})
      << "a second parent of the lidar hides nothing";
}

TEST(InspectChoices, AMountingOnWhichTransformsDisagreeIsAProblem) {
  const test::TemporaryFolder folder;
  const auto file = write(folder, with_transform("base_link", "imu", 1.5));
  EXPECT_EQ(kinds(file), Kinds{"mounting_ambiguous /imu"});
  EXPECT_NE(text_of(file, 1).find("the mounting of 'imu' on 'lidar' is ambiguous: with the "
                                  "transform from 'base_link' to 'imu' it is"),
            std::string::npos)
      << text_of(file, 1);
}

TEST(InspectChoices, ConstantTransformsOfMovingFramesAreNamed) {
  const test::TemporaryFolder folder;
  std::vector<Recorded> events;
  std::vector<StaticTransform> mountings;
  for (const Recorded& event : clean_recording()) {
    if (const auto* transform = std::get_if<StaticTransform>(&event.value)) {
      mountings.push_back(*transform);
    } else {
      events.push_back(event);
    }
  }
  for (int i = 0; i < 50; ++i) {
    for (const StaticTransform& mounting : mountings) {
      events.push_back({"/tf", kFirstStamp + std::chrono::milliseconds(100 * i), mounting});
    }
  }
  std::ranges::stable_sort(events, {}, &Recorded::received);
  EXPECT_EQ(kinds(write(folder, events)), Kinds{"constant_transforms"});
}

}  // namespace
}  // namespace adit
