// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/config_file.hpp"

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

/// A configuration file that lives as long as the test.
class ConfigFile : public testing::Test {
 protected:
  ConfigFile() {
    file_ = std::filesystem::path(testing::TempDir()) /
            (std::string("adit_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
             ".toml");
  }
  ~ConfigFile() override { std::filesystem::remove(file_); }

  Config load(const std::string& text, const std::vector<std::string>& overrides = {}) {
    std::ofstream(file_, std::ios::binary) << text;
    return load_config({.file = file_, .overrides = overrides});
  }

  /// The message that loading `text` ends with; empty when it is accepted.
  std::string refusal(const std::string& text) {
    try {
      load(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  }

  void expect_refused(const std::string& text, const std::vector<std::string>& parts) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find(file_.string()), std::string::npos) << message;
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos) << "no '" << part << "' in: " << message;
    }
  }

  std::filesystem::path file_;
};

std::string override_refusal(const std::string& text) {
  try {
    load_config({.file = {}, .overrides = {text}});
  } catch (const UsageError& error) {
    return error.what();
  }
  return {};
}

TEST_F(ConfigFile, AnEmptyFileGivesTheDefaults) {
  EXPECT_EQ(to_json(load("")), to_json(Config{}));
}

TEST_F(ConfigFile, WhatIsPrintedReadsBackAsTheSameConfiguration) {
  Config config;
  config.preprocess.r_input = 0.1 + 0.2;  // needs all 17 digits
  config.registration.rotation_epsilon = 1e-5;
  config.registration.d_max = 3;  // a whole number
  config.submap.l = 23;
  const Config again = load(to_toml(config));
  EXPECT_EQ(again.preprocess.r_input, config.preprocess.r_input);
  EXPECT_EQ(to_json(again), to_json(config));
  EXPECT_EQ(to_toml(again), to_toml(config));
}

TEST_F(ConfigFile, WhatIsPrintedNamesUnitAndDefaultOfEverySetting) {
  const std::string text = to_toml(Config{});
  EXPECT_NE(text.find("[m] returns nearer than this are dropped; default 0.5\nc_min = 0.5\n"),
            std::string::npos)
      << text;
}

TEST_F(ConfigFile, WhatIsNotGivenIsAbsentAndAnIdentityCanBeMeant) {
  const std::string text = to_toml(Config{});
  EXPECT_NE(text.find("default not given\n# T_imu_lidar = (not given)\n"), std::string::npos)
      << text;
  EXPECT_FALSE(load("").imu.T_imu_lidar);
  const Config identity = load("[imu]\nT_imu_lidar = [0, 0, 0, 0, 0, 0, 1]\n");
  ASSERT_TRUE(identity.imu.T_imu_lidar);
  EXPECT_NE(to_toml(identity).find("T_imu_lidar = [0.0,0.0,0.0,0.0,0.0,0.0,1.0]"),
            std::string::npos);
}

TEST_F(ConfigFile, ListsAreReadPrintedAndChecked) {
  const char* text =
      "[recording]\nfurther_sweep_topics = [\"/rear\", \"/left\"]\n"
      "T_lidar_further = [[1, 2, 3, 0, 0, 0, 1]]\n";
  const Config config = load(text);
  EXPECT_EQ(config.recording.further_sweep_topics, (std::vector<std::string>{"/rear", "/left"}));
  ASSERT_EQ(config.recording.T_lidar_further.size(), 1U);
  EXPECT_EQ(config.recording.T_lidar_further[0][1], 2.0);
  EXPECT_EQ(to_toml(load(to_toml(config))), to_toml(config));
  EXPECT_EQ(load_config({.file = {}, .overrides = {R"(recording.further_sweep_topics=["/rear"])"}})
                .recording.further_sweep_topics,
            std::vector<std::string>{"/rear"});
  EXPECT_THROW(load("[recording]\nfurther_sweep_topics = \"/rear\"\n"), InputError);
  EXPECT_THROW(load("[recording]\nT_lidar_further = [[0, 0, 0, 0, 0, 0, 1]]\n"), InputError)
      << "a pose of no sensor";
  EXPECT_THROW(load("[recording]\nfurther_sweep_topics = [\"/rear\"]\n"
                    "T_lidar_further = [[0, 0, 0, 0, 0, 0, 2]]\n"),
               InputError);
}

TEST_F(ConfigFile, SwitchesAreBooleansAndZeroAndOneStillServe) {
  EXPECT_FALSE(load("[imu]\nuse = false\n").imu.use);
  EXPECT_FALSE(load("[imu]\nuse = 0\n").imu.use);
  EXPECT_TRUE(load("[imu]\nuse = 1\n").imu.use);
  EXPECT_NE(to_toml(Config{}).find("deskew = true\n"), std::string::npos);
}

TEST_F(ConfigFile, IntegersServeAsNumbersAndOtherSettingsKeepTheirDefaults) {
  const Config config = load("[preprocess]\nc_max = 80\n");
  EXPECT_EQ(config.preprocess.c_max, 80.0);
  EXPECT_EQ(config.preprocess.c_min, Config{}.preprocess.c_min);
}

TEST_F(ConfigFile, UnknownKeyNamesFileLineColumnAndNearestName) {
  expect_refused(
      "[preprocess]\nc_min = 1\n  r_imput = 0.5\n",
      {"line 3, column 3", "'preprocess.r_imput'", "nearest valid name is 'preprocess.r_input'"});
}

TEST_F(ConfigFile, UnknownKeyThatResemblesNothingListsTheValidNames) {
  expect_refused("[keyframe]\nquantisation_of_time = 1\n",
                 {"line 2", "Valid are keyframe.delta_trans, keyframe.delta_rot"});
}

TEST_F(ConfigFile, UnknownSectionNamesFileLineAndNearestName) {
  expect_refused("\n[registraton]\nd_max = 1\n", {"line 2", "'registraton'", "'registration'"});
}

TEST_F(ConfigFile, SettingOutsideOfASectionIsRefused) {
  expect_refused("preprocess = 3\n", {"line 1", "[preprocess]"});
  expect_refused("c_min = 3\n", {"line 1", "no section 'c_min'"});
}

TEST_F(ConfigFile, WrongTypeNamesLineAndWhatWasExpected) {
  expect_refused("[preprocess]\nc_min = \"1\"\n",
                 {"line 2", "preprocess.c_min is the text '1'", "a number"});
  expect_refused("[preprocess]\nc_min = true\n", {"line 2", "boolean", "a number"});
  expect_refused("[submap]\nl = 2.5\n", {"line 2", "submap.l", "a whole number"});
  expect_refused("[submap]\nl = 99999999999\n", {"line 2", "submap.l is 99999999999", "smaller"});
  expect_refused("[mapping]\nloops = \"yes\"\n", {"is the text 'yes'", "Write true or false"});
  expect_refused("[submap.l]\n", {"line 1", "submap.l is a section"});
}

TEST_F(ConfigFile, SyntaxErrorNamesLine) {
  expect_refused("[preprocess]\nc_min = = 1\n", {"line 2", "not valid TOML"});
  expect_refused("[submap]\nl = 1\nl = 2\n", {"line 3", "not valid TOML"});
  expect_refused("[submap]\nl = 1\n[.5]\n", {"line 3", "not valid TOML"});
  expect_refused("[submap]\n\u00b2 = 1\n", {"line 2", "not valid TOML"});
  expect_refused("[submap]\nl = 1 \u00fc\n", {"line 2", "not valid TOML"});
}

TEST_F(ConfigFile, RefusedValueNamesItsLine) {
  expect_refused("[preprocess]\nc_min = 1\nc_max = 0.5\n",
                 {"line 3", "preprocess.c_max is 0.5", "c_min (1)"});
}

TEST_F(ConfigFile, RefusedRelationNamesTheLineOfTheSettingThatWasGiven) {
  // c_max has its default: the cause is line 2.
  expect_refused("[preprocess]\nc_min = 200\n", {"line 2", "preprocess.c_max is 100"});
  expect_refused("[preprocess]\nr_input = 10\n",
                 {"line 2", "preprocess.surface_size is 25", "follows from preprocess.r_input"});
}

TEST_F(ConfigFile, MissingFileAndFolderAreNamed) {
  EXPECT_THROW(load_config({.file = file_ / "nowhere.toml", .overrides = {}}), InputError);
  EXPECT_THROW(load_config({.file = testing::TempDir(), .overrides = {}}), InputError);
}

TEST_F(ConfigFile, OverridesWinOverTheFileAndTheLastOneOverTheOthers) {
  const Config config =
      load("[submap]\nl = 5\n[preprocess]\nc_min = 2\n", {"submap.l=6", "submap.l=7"});
  EXPECT_EQ(config.submap.l, 7);
  EXPECT_EQ(config.preprocess.c_min, 2.0);
}

TEST(ConfigOverride, EachRefusalIsAUsageErrorThatSaysWhatWouldDo) {
  EXPECT_NE(override_refusal("preprocess").find("section.key=value"), std::string::npos);
  EXPECT_NE(override_refusal("r_input=0.5").find("section.key=value"), std::string::npos);
  EXPECT_NE(override_refusal("preprocess.r_inptu=0.5").find("'preprocess.r_input'"),
            std::string::npos);
  EXPECT_NE(override_refusal("preproces.r_input=0.5").find("'preprocess'"), std::string::npos);
  EXPECT_NE(override_refusal("preprocess.r_input=half").find("Write a number, such as 0.5"),
            std::string::npos);
  EXPECT_NE(override_refusal("preprocess.r_input=").find("is not a value"), std::string::npos);
  EXPECT_NE(override_refusal("submap.l=2.5").find("whole number"), std::string::npos);
  EXPECT_NE(override_refusal("submap.l=0").find("submap.l is 0; must be"), std::string::npos);
  EXPECT_NE(override_refusal("imu.use=2").find("Write true or false"), std::string::npos);
  EXPECT_NE(override_refusal("imu.use=0.0").find("Write true or false"), std::string::npos);
  EXPECT_NE(override_refusal("submap.l=1\n[x]").find("section.key=value"), std::string::npos);
  EXPECT_NE(override_refusal("].l=1").find("without spaces"), std::string::npos);
}

TEST(ConfigOverride, WhatFollowsFromALengthIsRefusedByItsName) {
  EXPECT_EQ(override_refusal("preprocess.r_input=10"),
            "--set preprocess.r_input=10: preprocess.surface_size is 25; must be between 0 and 20 "
            "m; it follows from preprocess.r_input (10).");
  for (const char* value : {"9", "0.01", "0.02"}) {
    EXPECT_NE(override_refusal("preprocess.r_input=" + std::string(value))
                  .find("it follows from preprocess.r_input (" + std::string(value) + ")"),
              std::string::npos)
        << value;
  }
  EXPECT_NE(override_refusal("preprocess.surface_size=30").find("surface_size is 30; must be"),
            std::string::npos);
  EXPECT_EQ(override_refusal("preprocess.surface_size=30").find("follows"), std::string::npos);
}

TEST(ConfigOverride, NoiseOfACustomSensorNeedsOne) {
  EXPECT_NE(override_refusal("imu.gyro_noise=0.01").find("set imu.sensor=custom"),
            std::string::npos);
  const Config custom =
      load_config({.file = {}, .overrides = {"imu.gyro_noise=0.01", "imu.sensor=custom"}});
  EXPECT_EQ(custom.imu.gyro_noise, 0.01);
  EXPECT_EQ(changed_settings(custom),
            (std::vector<std::string>{"imu.sensor=\"custom\"", "imu.gyro_noise=0.01"}));
  EXPECT_EQ(parse_config("[imu]\ngyro_noise = 0.01\n", "a map of before").imu.gyro_noise,
            ImuConfig{}.gyro_noise);
}

TEST(ConfigOverride, TextNeedsNoQuotesThatAShellWouldTakeAway) {
  const Config config = load_config(
      {.file = std::nullopt,
       .overrides = {"imu.sensor=vn100", "recording.sweep_topic=/os_cloud_node/points"}});
  EXPECT_EQ(config.imu.sensor, "vn100");
  EXPECT_EQ(config.recording.sweep_topic, "/os_cloud_node/points");
  EXPECT_EQ(load_config({.file = std::nullopt, .overrides = {"imu.sensor=\"vn100\""}}).imu.sensor,
            "vn100");
}

TEST(NearestName, EditDistanceCountsInsertionsDeletionsReplacementsAndSwaps) {
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("r_input", "r_imput"), 1U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("rnu", "run"), 1U);
}

TEST(NearestName, FarWordsAreAnsweredWithTheList) {
  EXPECT_EQ(suggestion("rnu", {"run", "devices"}), "The nearest valid name is 'run'");
  EXPECT_EQ(suggestion("zzz", {"run", "devices"}), "Valid are run, devices");
  EXPECT_EQ(suggestion("zzz", {"run"}), "The only valid name is 'run'");
  EXPECT_EQ(suggestion("C_MIN", {"c_max", "c_min"}), "The nearest valid name is 'c_min'");
}

TEST(NearestName, DashesDoNotMakeOptionsAlike) {
  EXPECT_EQ(suggestion("--sweeps", {"--help", "--count"}), "Valid are --help, --count");
  EXPECT_EQ(suggestion("--conut", {"--help", "--count"}), "The nearest valid name is '--count'");
  EXPECT_EQ(suggestion("--", {"--help", "--count"}), "Valid are --help, --count");
}

}  // namespace
}  // namespace adit
