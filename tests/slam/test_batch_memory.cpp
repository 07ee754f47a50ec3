// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Batches on a device whose memory ends.
#include <cstring>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/registration/batch_aligner.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

constexpr uint64_t kMebibyte = uint64_t{1} << 20U;

TEST(BatchMemory, RunningOutInABatchIsAnErrorAndTheNextCallGivesTheSameBits) {
  engine::ContextOptions options = test::test_options();
  options.memory_budget_bytes = 64 * kMebibyte;
  engine::Context context(options);
  const test::Lidar lidar{.beams = 64};
  PreprocessConfig config;
  config.beam_spacing = lidar.beam_spacing();
  AlignmentClouds maker(context, config);
  const test::World world = test::make_street(30.0);
  std::vector<SurfaceCloud> clouds;
  std::vector<AlignmentTarget> targets;
  const std::vector<StampedPose> poses = test::steady_drive(4, test::twist(0.5, 0.02));
  for (const StampedPose& pose : poses) {
    clouds.push_back(maker.make_cloud(test::scan(world, pose, lidar).points));
    targets.push_back(
        maker.make_target(clouds.back(), RegistrationMethod::vgicp, std::vector{1.0}));
  }
  std::vector<AlignmentPair> pairs;
  for (size_t i = 0; i < 64; ++i) {
    pairs.push_back({.source = &clouds[i % 4], .target = &targets[(i / 4) % 4]});
  }
  AlignmentSettings settings;
  settings.d_max = 1.0;
  BatchAligner aligner(context, settings);
  const std::vector<RegistrationResult> before = aligner.align(pairs);
  const uint64_t in_use = context.memory_in_use();

  // Nearly nothing is left: some buffers of the batch can be made, the others cannot.
  std::vector<engine::Buffer> ballast;
  for (uint64_t bytes = 32 * kMebibyte; bytes >= 4096; bytes /= 2) {
    try {
      while (true) {
        ballast.push_back(context.make_buffer(bytes, engine::Memory::device, "ballast"));
      }
    } catch (const engine::OutOfMemory&) {
      continue;
    }
  }
  EXPECT_THROW(aligner.align(pairs), engine::OutOfMemory);
  ballast.clear();
  EXPECT_EQ(context.memory_in_use(), in_use) << "the batch that failed keeps nothing";

  const std::vector<RegistrationResult> after = aligner.align(pairs);
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i < after.size(); ++i) {
    EXPECT_TRUE(is_usable(after[i].status)) << i << ": " << to_string(after[i].status);
    EXPECT_EQ(std::memcmp(after[i].T_target_source.data(), before[i].T_target_source.data(),
                          16 * sizeof(double)),
              0)
        << i;
  }
  EXPECT_EQ(context.validation_messages(), std::vector<std::string>{});
}

}  // namespace
}  // namespace adit
