// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/presets.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "adit/tools/setup/config_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

TEST(Presets, EachIsAValidConfiguration) {
  EXPECT_TRUE(std::ranges::is_sorted(preset_names()));
  for (const std::string& name : preset_names()) {
    Config config;
    apply_preset(name, config);
    EXPECT_FALSE(validate(config)) << name;
    EXPECT_EQ(config.recording.sweep_topic.has_value(), config.recording.imu_topic.has_value())
        << name;
  }
}

TEST(Presets, MountingsAreKnownWhereTheRecordingsDoNotTellThem) {
  Config config;
  apply_preset("newer-college", config);
  // Half a turn about z: the lidar's axes and the housing's.
  EXPECT_EQ((*config.imu.T_imu_lidar)[5], 1.0);
  EXPECT_NEAR((*config.imu.T_imu_lidar)[2], 0.03618 - 0.007645, 1e-9);
  Config other;
  apply_preset("subt-mrs", other);
  EXPECT_FALSE(other.imu.T_imu_lidar);
}

TEST(Presets, WhatIsGivenBesideThemWins) {
  const ConfigSource source{
      .file = {}, .overrides = {"recording.imu_topic=\"/camera/imu\""}, .preset = "newer-college"};
  const Config config = load_config(source);
  EXPECT_EQ(config.recording.sweep_topic, "/os1_cloud_node/points");
  EXPECT_EQ(config.recording.imu_topic, "/camera/imu");
}

TEST(Presets, NamesThatAreNotKnownGetTheNearest) {
  Config config;
  try {
    apply_preset("newercollege", config);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("newer-college"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace adit
