// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit loops --add`, on a map that a run has made.
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/command_loops.hpp"
#include "adit/tools/commands/command_run.hpp"

namespace adit {
namespace {

using test::Ran;

class LoopsAdd : public testing::Test {
 protected:
  LoopsAdd() {
    RunCommandOptions run;
    run.recording = test::small_recording(folder_.path(), 12).recording;
    run.output = folder_ / "out";
    run.overwrite = true;
    run.config.overrides = {"preprocess.beam_spacing=0.03", "mapping.loops=false",
                            "keyframe.delta_trans=0.2"};
    std::ostringstream said;
    EXPECT_EQ(run_command(run, said, said), 0) << said.str();
    options_.map = folder_ / "out/map.adit";
    options_.add = {0, static_cast<int64_t>(keyframes().size()) - 1};
    EXPECT_GT(options_.add[1], 2);
  }

  std::vector<MapKeyframe> keyframes() const {
    return MapDatabase(options_.map, MapAccess::read).keyframes();
  }
  std::string dump() const { return test::dump_of(MapDatabase(options_.map, MapAccess::read)); }
  /// How the second keyframe lies, a little off.
  std::vector<double> guess() const {
    const Eigen::Isometry3d way =
        keyframes().front().T_map_keyframe.inverse() * keyframes().back().T_map_keyframe;
    const Eigen::Vector3d p = way.translation();
    const double yaw = std::atan2(way(1, 0), way(0, 0));
    return {p.x() + 0.2, p.y() - 0.1, p.z(), yaw * kDegreesPerRadian + 2.0};
  }

  const test::TemporaryFolder folder_;
  LoopsCommandOptions options_;
};

TEST_F(LoopsAdd, WhatHoldsIsLetInListedAndCanBeRevoked) {
  const std::size_t edges = MapDatabase(options_.map, MapAccess::read).graph().edges().size();
  const Ran added = test::ran(loops_command, options_);
  ASSERT_EQ(added.code, 0) << added.err;
  EXPECT_NE(added.out.find("added   loop 1; cost"), std::string::npos) << added.out;
  EXPECT_NE(added.out.find("added_by_hand"), std::string::npos) << added.out;
  const MapDatabase map(options_.map, MapAccess::read);
  ASSERT_EQ(map.graph().edges().size(), edges + 1);
  EXPECT_EQ(map.graph().edges().back().kind, EdgeKind::loop);
  EXPECT_GT(map.candidates().front().overlap, 0.4);
  EXPECT_TRUE(map.check().empty());
  const Ran again = test::ran(loops_command, options_);
  EXPECT_EQ(again.code, 2);
  EXPECT_NE(again.err.find("loop 1 is between the two, and accepted"), std::string::npos);
  EXPECT_EQ(test::ran(loops_command, {.map = options_.map, .revoke = 1}).code, 0);
  const Ran restored = test::ran(loops_command, {.map = options_.map, .restore = 1, .json = true});
  EXPECT_EQ(restored.code, 0) << restored.err;
  const auto loop = nlohmann::json::parse(restored.out).at("loops")[0];
  EXPECT_EQ(loop.at("found_by"), "hand");
  EXPECT_EQ(loop.at("reason"), "added_by_hand");
}

TEST_F(LoopsAdd, AGuessMayComeFromEitherEnd) {
  options_.guess = guess();
  const Ran forth = test::ran(loops_command, options_);
  ASSERT_EQ(forth.code, 0) << forth.err;
  const auto poses = keyframes();
  const Eigen::Isometry3d way =
      MapDatabase(options_.map, MapAccess::read).candidates()[0].T_from_to;
  EXPECT_LT((way.inverse() * (poses.front().T_map_keyframe.inverse() * poses.back().T_map_keyframe))
                .translation()
                .norm(),
            0.05);
}

TEST_F(LoopsAdd, WhatDoesNotHoldIsRefusedAndNothingChanges) {
  const std::string before = dump();
  options_.guess = {25.0, 3.0, 0.0, 90.0};
  const Ran refused = test::ran(loops_command, options_);
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("there is no loop as it was said"), std::string::npos) << refused.err;
  EXPECT_EQ(dump(), before);
}

TEST_F(LoopsAdd, WhatCannotBeAskedIsAUsageError) {
  const auto code = [&](std::vector<int64_t> add, std::vector<double> guess = {}) {
    return test::ran(loops_command,
                     {.map = options_.map, .add = std::move(add), .guess = std::move(guess)})
        .code;
  };
  EXPECT_EQ(code({0, 4711}), 2);
  EXPECT_EQ(code({-1, 2}), 2);
  EXPECT_EQ(code({2, 2}), 2);
  EXPECT_EQ(code({}, {0.0, 0.0, 0.0, 0.0}), 2);
  LoopsCommandOptions both = options_;
  both.revoke = 1;
  EXPECT_EQ(test::ran(loops_command, both).code, 2);
}

}  // namespace
}  // namespace adit
