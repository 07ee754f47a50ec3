// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/config.hpp"

namespace adit {
namespace {

struct BadSetting {
  std::string field;
  std::function<void(Config&)> spoil;
  std::string must;  ///< a part of the message
};

std::vector<BadSetting> bad_settings() {
  return {
      {"preprocess.c_min", [](Config& c) { c.preprocess.c_min = -1; }, "is -1; must be between 0"},
      {"preprocess.c_max", [](Config& c) { c.preprocess.c_max = 0.2; },
       "greater than preprocess.c_min (0.5)"},
      {"preprocess.c_max", [](Config& c) { c.preprocess.c_max = 1e6; }, "at most 1000 m"},
      {"preprocess.r_input", [](Config& c) { c.preprocess.r_input = 0.001; },
       "is 0.001; must be between 0.01"},
      {"preprocess.r_input",
       [](Config& c) { c.preprocess.c_max = 0.6, c.preprocess.r_input = 0.7; },
       "less than preprocess.c_max (0.6)"},
      {"preprocess.beam_spacing", [](Config& c) { c.preprocess.beam_spacing = 0.001; }, "rad"},
      {"preprocess.surface_size", [](Config& c) { c.preprocess.surface_size = -1; }, "m"},
      {"registration.method", [](Config& c) { c.registration.method = "icp"; }, "vgicp or ndt"},
      {"registration.r_align",
       [](Config& c) { c.registration.r_align = 0.2, c.preprocess.r_input = 0.25; },
       "at least preprocess.r_input ("},
      {"registration.r_align",
       [](Config& c) { c.preprocess.c_max = 990.0, c.registration.r_align = 1.0; },
       "or preprocess.c_max (990) smaller"},
      {"registration.r_align",
       [](Config& c) { c.registration.r_align = 20.0, c.preprocess.r_input = 0.1; },
       "65535 is the most"},
      {"registration.d_max", [](Config& c) { c.registration.d_max = -1; }, "is -1"},
      {"registration.max_iterations", [](Config& c) { c.registration.max_iterations = 0; },
       "between 1 and"},
      {"registration.translation_epsilon",
       [](Config& c) { c.registration.translation_epsilon = 0; }, "greater than 0"},
      {"registration.translation_epsilon",
       [](Config& c) { c.registration.translation_epsilon = 5; }, "less than registration.d_max ("},
      {"registration.rotation_epsilon", [](Config& c) { c.registration.rotation_epsilon = 1; },
       "0.1 rad"},
      {"registration.min_inliers", [](Config& c) { c.registration.min_inliers = 5; }, "at least 6"},
      {"registration.min_overlap", [](Config& c) { c.registration.min_overlap = 1; },
       "less than 1"},
      {"submap.l", [](Config& c) { c.submap.l = 0; }, "clouds"},
      {"submap.delta_trans", [](Config& c) { c.submap.delta_trans = -1.0; }, "between 0 and 100 m"},
      {"submap.delta_rot", [](Config& c) { c.submap.delta_rot = 4.0; }, "rad"},
      {"mapping.r_submap", [](Config& c) { c.mapping.r_submap = 0.001; }, "between 0.02 and 10 m"},
      {"mapping.r_submap",
       [](Config& c) {
         c.preprocess.c_max = 300.0, c.registration.r_align = 1.0, c.mapping = {true, 0.2, 5};
       },
       "or preprocess.c_max (300) or"},
      {"registration.r_align",
       [](Config& c) {
         c.keyframe.delta_trans = 200.0, c.registration.r_align = 0.5, c.mapping = {true, 0.5, 5};
       },
       "keyframe.delta_trans (200) smaller"},
      {"mapping.delay", [](Config& c) { c.mapping.delay = -1; }, "between 0 and 1000"},
      {"keyframe.delta_trans", [](Config& c) { c.keyframe.delta_trans = 0; }, "greater than 0"},
      {"keyframe.delta_rot", [](Config& c) { c.keyframe.delta_rot = 4; }, "at most pi"},
      {"imu.T_imu_lidar", [](Config& c) { c.imu.T_imu_lidar = {0, 0, 0, 0, 0, 0, 0.5}; },
       "length 1"},
      {"imu.sensor", [](Config& c) { c.imu.sensor = "bmi089"; }, "bmi088"},
      {"imu.noise_scale", [](Config& c) { c.imu.noise_scale = 0.0; }, "between 0.1"},
      {"imu.gyro_noise", [](Config& c) { c.imu.gyro_noise = 0.0; }, "rad/s/sqrt(Hz)"},
      {"imu.accel_noise", [](Config& c) { c.imu.accel_noise = 100.0; }, "m/s^2/sqrt(Hz)"},
      {"imu.gyro_walk", [](Config& c) { c.imu.gyro_walk = 0.0; }, "rad/s^2/sqrt(Hz)"},
      {"imu.accel_walk", [](Config& c) { c.imu.accel_walk = 0.0; }, "m/s^3/sqrt(Hz)"},
      {"imu.gyro_noise", [](Config& c) { c.imu.gyro_noise = 0.01; }, "set imu.sensor=custom"},
      {"imu.accel_noise", [](Config& c) { c.imu.accel_noise = 0.1; }, "set imu.sensor=custom"},
      {"imu.gyro_walk", [](Config& c) { c.imu.gyro_walk = 0.01; }, "set imu.sensor=custom"},
      {"imu.accel_walk", [](Config& c) { c.imu.accel_walk = 0.01; }, "set imu.sensor=custom"},
      {"imu.gravity_walk", [](Config& c) { c.imu.gravity_walk = 0.0; }, "rad/sqrt(s)"},
      {"imu.gravity_walk_way", [](Config& c) { c.imu.gravity_walk_way = -1.0; }, "rad/sqrt(m)"},
      {"imu.max_gap", [](Config& c) { c.imu.max_gap = 10.0; }, "and 1 s"},
      {"imu.max_rate", [](Config& c) { c.imu.max_rate = 0.0; }, "rad/s"},
      {"imu.max_acceleration", [](Config& c) { c.imu.max_acceleration = 0.0; }, "m/s^2"},
      {"recovery.max_speed", [](Config& c) { c.recovery.max_speed = 0.0; }, "m/s"},
      {"imu.lag", [](Config& c) { c.imu.lag = 1; }, "between 2"},
      {"imu.wait", [](Config& c) { c.imu.wait = -0.1; }, "between 0 and 10 s"},
      {"imu.reset", [](Config& c) { c.imu.reset = 1; }, "at least 2 sweeps"},
      {"recovery.max_coasting", [](Config& c) { c.recovery.max_coasting = -1; }, "between 0"},
      {"recording.point_time_unit", [](Config& c) { c.recording.point_time_unit = -1; }, "s"},
      {"recording.coordinate_scale", [](Config& c) { c.recording.coordinate_scale = -1; }, "m"},
      {"recording.spin_rate", [](Config& c) { c.recording.spin_rate = 0.5; }, "turns a second"},
      {"recording.beam_elevation", [](Config& c) { c.recording.beam_elevation = 1.0; }, "rad"},
      {"recording.sweep_time_offset", [](Config& c) { c.recording.sweep_time_offset = 1e12; },
       "between"},
      {"recording.imu_time_offset", [](Config& c) { c.recording.imu_time_offset = -1e12; },
       "between"},
      {"recording.accelerometer_scale", [](Config& c) { c.recording.accelerometer_scale = 0; },
       "0"},
      {"recording.floats_per_point", [](Config& c) { c.recording.floats_per_point = 2; },
       "0, or 3 to 8"},
      {"recording.gyroscope_scale", [](Config& c) { c.recording.gyroscope_scale = 0; }, "0"},
      {"gnss.antenna",
       [](Config& c) {
         c.gnss.antenna = {0, 0, 1e4};
       },
       "m"},
      {"gnss.noise_scale", [](Config& c) { c.gnss.noise_scale = 0; }, "between 0.1"},
      {"gnss.correlation", [](Config& c) { c.gnss.correlation = 0; }, "and 3600 s"},
      {"gnss.time_offset", [](Config& c) { c.gnss.time_offset = 1e12; }, "between"},
      {"gnss.heading_sigma", [](Config& c) { c.gnss.heading_sigma = 0; }, "between"},
      {"gnss.heading_offset", [](Config& c) { c.gnss.heading_offset = 2; }, "between"},
      {"velocity.T_lidar_sensor",
       [](Config& c) { c.velocity.T_lidar_sensor = {0, 0, 0, 0, 0, 0, 2}; },
       "quaternion has the length 1"},
      {"velocity.sigma", [](Config& c) { c.velocity.sigma = 0; }, "between"},
      {"velocity.scale_sigma", [](Config& c) { c.velocity.scale_sigma = 2; }, "between"},
      {"velocity.turn_sigma", [](Config& c) { c.velocity.turn_sigma = 0; }, "between"},
      {"velocity.time_offset", [](Config& c) { c.velocity.time_offset = 1e12; }, "between"},
  };
}

/// Calls act(dotted name, value) for each setting.
void for_each_setting(Config& config, const auto& act) {
  Config::visit(config, [&](const std::string& section, auto& fields) {
    std::decay_t<decltype(fields)>::visit(fields, [&](const char* name, auto& value, auto&&...) {
      act(section + "." + name, value);
    });
  });
}

TEST(Config, DefaultsAreValid) {
  EXPECT_FALSE(validate(Config{}).has_value());
}

TEST(Config, EachBadSettingIsNamedWithItsValueAndWhatWouldDo) {
  for (const BadSetting& bad : bad_settings()) {
    Config config;
    bad.spoil(config);
    const auto problem = validate(config);
    ASSERT_TRUE(problem.has_value()) << bad.field << ": " << bad.must;
    EXPECT_EQ(problem->field, bad.field);
    EXPECT_NE(problem->message.find(bad.must), std::string::npos) << problem->message;
  }
}

TEST(Config, EverySettingIsChecked) {
  std::set<std::string> checked;
  for (const BadSetting& bad : bad_settings()) checked.insert(bad.field);
  Config config;
  for_each_setting(config, [&](const std::string& name, auto& value) {
    using Value = std::decay_t<decltype(value)>;
    // No text is bad, nor a switch.
    if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
      EXPECT_TRUE(checked.contains(name)) << name << " has no bad value in this test";
    }
  });
}

TEST(Config, NumbersThatAreNotFiniteAreRefusedInEveryField) {
  Config names;
  for_each_setting(names, [&](const std::string& name, auto& value) {
    if constexpr (std::is_floating_point_v<std::decay_t<decltype(value)>>) {
      for (const double odd : {std::nan(""), std::numeric_limits<double>::infinity()}) {
        const double before = std::exchange(value, odd);
        const auto problem = validate(names);
        ASSERT_TRUE(problem.has_value()) << name;
        EXPECT_EQ(problem->field, name);
        value = before;
      }
    }
  });
}

TEST(Lengths, ThatAreLeftOpenFollowFromTheVoxelSizeOfTheInput) {
  const Config usual = with_lengths({});
  EXPECT_EQ(usual.preprocess.r_input, 0.25);
  EXPECT_EQ(usual.preprocess.surface_size, 0.625);
  EXPECT_EQ(usual.registration.r_align, 0.5);
  EXPECT_EQ(usual.registration.d_max, 0.5);
  EXPECT_EQ(usual.preprocess.c_max, 100.0);
  const Config near = with_lengths({}, 0.05);
  EXPECT_EQ(near.registration.r_align, 0.1);
  EXPECT_NEAR(near.preprocess.c_max, 41.1, 1e-9) << "as far as the keys of such voxels reach";
  EXPECT_FALSE(validate(near).has_value());
}

TEST(Lengths, GaussiansNeedLargerVoxels) {
  Config ndt;
  ndt.registration.method = "ndt";
  EXPECT_EQ(with_lengths(ndt).registration.r_align, 1.0);
}

TEST(Lengths, ThatAreStatedStayAndTheOthersFollowThem) {
  Config stated;
  stated.preprocess.r_input = 0.5;
  stated.registration.d_max = 0.7;
  const Config filled = with_lengths(stated, 0.05);
  EXPECT_EQ(filled.preprocess.r_input, 0.5);
  EXPECT_EQ(filled.registration.r_align, 1.0);
  EXPECT_EQ(filled.registration.d_max, 0.7);
  Config coarse;
  coarse.registration.r_align = 0.3;
  EXPECT_EQ(with_lengths(coarse).preprocess.r_input, 0.15) << "points are finer than voxels";
}

}  // namespace
}  // namespace adit
