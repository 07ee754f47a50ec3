// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/map_use.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/run/run_options.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

class MapUseTest : public testing::Test {
 protected:
  MapUseTest() {
    std::filesystem::create_directories(folder_ / "site");
    test::write_full_map(folder_ / "site/map.adit");
    options_.recording = "drive.mcap";
    options_.output = folder_ / "out";
    config_.mapping.enabled = config_.mapping.loops = true;
  }

  std::optional<MapUse> use() const { return map_use(options_, config_); }

  test::TemporaryFolder folder_;
  RunCommandOptions options_;
  Config config_;
};

TEST_F(MapUseTest, AMapByItselfIsToBeLocalisedIn) {
  EXPECT_FALSE(use().has_value());
  options_.earlier_map.map = folder_ / "site";
  ASSERT_TRUE(use().has_value());
  EXPECT_EQ(use()->map, folder_ / "site/map.adit");
  EXPECT_FALSE(use()->extends);
  EXPECT_EQ(use()->earlier_sessions(), EarlierSessions::keep);
  options_.earlier_map.extend = true;
  EXPECT_TRUE(use()->extends);
  EXPECT_EQ(use()->earlier_sessions(), EarlierSessions::move);
  options_.earlier_map.keep = true;
  EXPECT_EQ(use()->earlier_sessions(), EarlierSessions::keep);
}

TEST_F(MapUseTest, WhatDoesNotFitTogetherIsRefused) {
  options_.earlier_map.localize = true;
  EXPECT_THROW(use(), UsageError) << "no map";
  options_.earlier_map.map = folder_ / "site/map.adit";
  EXPECT_NO_THROW(use());
  options_.earlier_map.extend = true;
  EXPECT_THROW(use(), UsageError) << "both";
  options_.earlier_map.localize = options_.earlier_map.extend = false;
  options_.earlier_map.keep = true;
  EXPECT_THROW(use(), UsageError) << "nothing moves anyway";
  options_.earlier_map.keep = false;
  options_.continues = true;
  EXPECT_THROW(use(), UsageError);
  options_.continues = false;
  options_.output = folder_ / "site";
  EXPECT_THROW(use(), UsageError) << "the map would be replaced";
  options_.output = folder_ / "out";
  config_.mapping.loops = false;
  EXPECT_THROW(use(), UsageError);
  config_.mapping.enabled = false;
  EXPECT_THROW(use(), UsageError);
}

TEST_F(MapUseTest, AStartIsInMetresAndDegreesAndNeedsAMap) {
  options_.earlier_map.pose = {1.0, -2.0, 0.5, 90.0};
  EXPECT_THROW(use(), UsageError);
  options_.earlier_map.map = folder_ / "site";
  ASSERT_TRUE(use()->start);
  EXPECT_EQ(use()->start->position, Eigen::Vector3d(1.0, -2.0, 0.5));
  EXPECT_NEAR(use()->start->heading, 1.5708, 1e-4);
  options_.earlier_map.pose[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(use(), UsageError);
  options_.earlier_map.pose = {2e6, 0.0, 0.0, 0.0};
  EXPECT_THROW(use(), UsageError);
}

TEST_F(MapUseTest, AMapThatIsMissingEmptyOrNoneIsAnInputError) {
  options_.earlier_map.map = folder_ / "nowhere";
  EXPECT_THROW(use(), InputError);
  { const MapDatabase empty(folder_ / "empty.adit", MapAccess::write); }
  options_.earlier_map.map = folder_ / "empty.adit";
  EXPECT_THROW(use(), InputError);
  options_.earlier_map.map = folder_.write("text.adit", "this is no map");
  EXPECT_THROW(use(), InputError);
}

TEST_F(MapUseTest, AMapIsExtendedByAnotherRecordingAlone) {
  MapSession session{.name = "drive", .provenance = {{"recording fingerprint", "1234"}}};
  {
    MapDatabase map(folder_ / "site/map.adit", MapAccess::write);
    map.add_session(session);
  }
  const MapUse use{.map = folder_ / "site/map.adit", .extends = true};
  EXPECT_THROW(require_new_recording(use, session), InputError);
  session.provenance.front().second = "5678";
  EXPECT_NO_THROW(require_new_recording(use, session));
}

}  // namespace
}  // namespace adit
