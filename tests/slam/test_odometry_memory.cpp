// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "adit/engine/error.hpp"
#include "adit/tests/slam/odometry_fixture.hpp"

namespace adit {
namespace {

using test::Drive;
using test::expect_sane;
using test::make_drive;
using test::street_config;

class MemoryBudgetTest : public testing::Test {};

TEST_F(MemoryBudgetTest, ASweepTooLargeForItIsRefusedAndSmallerOnesGoOn) {
  engine::ContextOptions options = test::test_options();
  options.memory_budget_bytes = 24ULL << 20U;
  engine::Context context(options);
  const Drive drive = make_drive(6, 1.0);
  {
    Odometry odometry(context, street_config());
    for (size_t i = 0; i < 3; ++i) {
      expect_sane(odometry.step(drive.sweeps[i]));
    }
    Sweep huge;  // tables of a hundred megabytes
    huge.points.resize(1'000'000);
    EXPECT_THROW(odometry.step(huge), engine::OutOfMemory);
    for (size_t i = 4; i < 6; ++i) {
      const SweepResult result = odometry.step(drive.sweeps[i]);
      expect_sane(result);
      EXPECT_EQ(result.state, OdometryState::tracking) << "sweep " << i;
      EXPECT_LE(drive.error(result, i).translation, 0.06) << "sweep " << i;
    }
  }
  EXPECT_EQ(context.memory_in_use(), 0U) << "everything was given back";
  EXPECT_EQ(context.validation_messages(), std::vector<std::string>{});
}

TEST_F(MemoryBudgetTest, ABudgetTooSmallForTheSubmapIsToldWhenTheOdometryIsMade) {
  engine::ContextOptions options = test::test_options();
  options.memory_budget_bytes = 2ULL << 20U;
  engine::Context context(options);
  try {
    const Odometry odometry(context, street_config());
    FAIL() << "a voxel map of 3 MiB fits into 2 MiB";
  } catch (const engine::OutOfMemory& error) {
    EXPECT_NE(std::string(error.what()).find("voxel map"), std::string::npos) << error.what();
  }
  EXPECT_EQ(context.memory_in_use(), 0U);
  const engine::Buffer still_usable = context.make_buffer(1024, engine::Memory::device, "small");
  EXPECT_EQ(still_usable.size(), 1024U);
}

TEST_F(MemoryBudgetTest, ASweepLargerThanAnyTableIsRefusedByName) {
  engine::Context context(test::test_options());
  Odometry odometry(context, street_config());
  Sweep sweep;
  sweep.source = "huge.bin";
  sweep.points.resize((size_t{1} << 21U) + 1);
  try {
    odometry.step(sweep);
    FAIL() << "it was taken";
  } catch (const engine::Error& error) {
    EXPECT_NE(std::string(error.what()).find("huge.bin"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace adit
