// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Published trajectories of KITTI odometry 00 against its ground truth. The figures are those of
// evo, the field's usual program, to the six decimals that it prints.
#include <gtest/gtest.h>

#include "adit/tests/support/shared_data.hpp"
#include "adit/tools/evaluation/evaluate.hpp"

namespace adit {
namespace {

constexpr double kSixDecimals = 0.5e-6;

Evaluation evaluate_files(const std::filesystem::path& folder, const char* estimate,
                          const EvaluationOptions& options = {}) {
  return evaluate(read_trajectory(folder / estimate), read_trajectory(folder / "KITTI_00_gt.txt"),
                  options);
}

TEST(EvaluatePublished, OrbSlamAbsoluteErrors) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "evaluation_kitti_00");
  const Evaluation result = evaluate_files(folder, "KITTI_00_ORB.txt");
  EXPECT_EQ(result.ate.count, 4541U);
  EXPECT_NEAR(result.ate.rmse, 1.303450, kSixDecimals);
  EXPECT_NEAR(result.ate.mean, 1.156997, kSixDecimals);
  EXPECT_NEAR(result.ate.median, 1.065625, kSixDecimals);
  EXPECT_NEAR(result.ate.std, 0.600282, kSixDecimals);
  EXPECT_NEAR(result.ate.min, 0.069313, kSixDecimals);
  EXPECT_NEAR(result.ate.max, 3.587949, kSixDecimals);
  EXPECT_NEAR(result.ate.sse, 7715.073440, 1e-5);
  EXPECT_NEAR(result.ate_unaligned.rmse, 7.790289, kSixDecimals);
  EXPECT_NEAR(result.ate_rotation.rmse, 0.756301, kSixDecimals);
  EXPECT_NEAR(result.ate_rotation.max, 6.752584, kSixDecimals);
}

TEST(EvaluatePublished, SptamAbsoluteErrors) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "evaluation_kitti_00");
  const Evaluation result = evaluate_files(folder, "KITTI_00_SPTAM.txt");
  EXPECT_NEAR(result.ate.rmse, 3.738488, kSixDecimals);
  EXPECT_NEAR(result.ate.mean, 3.490977, kSixDecimals);
  EXPECT_NEAR(result.ate.max, 7.768977, kSixDecimals);
}

TEST(EvaluatePublished, OtherAlignments) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "evaluation_kitti_00");
  EvaluationOptions options;
  options.alignment = Alignment::sim3;
  EXPECT_NEAR(evaluate_files(folder, "KITTI_00_ORB.txt", options).ate.rmse, 0.937709, kSixDecimals);
  // Not to the last digit: evo takes the first pose's matrix as rounded in the file, here it is
  // made a rotation.
  options.alignment = Alignment::origin;
  EXPECT_NEAR(evaluate_files(folder, "KITTI_00_ORB.txt", options).ate.rmse, 7.790305, 2e-5);
}

TEST(EvaluatePublished, RelativeErrorsPerTenMetres) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "evaluation_kitti_00");
  EvaluationOptions options;
  EXPECT_NEAR(evaluate_files(folder, "KITTI_00_ORB.txt", options).rpe.translation.rmse, 0.226261,
              kSixDecimals);
  options.rpe.from_first_pose = true;  // evo from 1.37 on
  EXPECT_NEAR(evaluate_files(folder, "KITTI_00_ORB.txt", options).rpe.translation.rmse, 0.236763,
              1e-6);
  options.rpe.pairs_from = PairSource::truth;
  const RelativeErrors by_truth = evaluate_files(folder, "KITTI_00_ORB.txt", options).rpe;
  EXPECT_NEAR(by_truth.translation.rmse, 0.228096, 1e-6);
  EXPECT_NEAR(by_truth.rotation.rmse, 0.642153, 5e-6);
}

TEST(EvaluatePublished, RelativeErrorsPerFrames) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "evaluation_kitti_00");
  EvaluationOptions options;
  options.rpe.unit = DeltaUnit::frames;
  options.rpe.delta = 1.0;
  EXPECT_NEAR(evaluate_files(folder, "KITTI_00_ORB.txt", options).rpe.translation.rmse, 0.028120,
              1e-6);
  options.rpe.delta = 10.0;
  EXPECT_NEAR(evaluate_files(folder, "KITTI_00_ORB.txt", options).rpe.translation.rmse, 0.194008,
              1e-6);
}

TEST(EvaluatePublished, SegmentErrorsAreThoseOfThePaper) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "evaluation_kitti_00");
  // ORB-SLAM2 (Mur-Artal and Tardos 2017), table I, sequence 00: 0.70 %, 0.25 deg/100 m.
  const SegmentErrors errors = evaluate_files(folder, "KITTI_00_ORB.txt").all_segments;
  EXPECT_NEAR(100.0 * errors.translation, 0.70, 0.005);
  EXPECT_NEAR(100.0 * errors.rotation * 57.29577951308232, 0.25, 0.005);
}

TEST(EvaluatePublished, TimesGiveTheSamePairsAsIndices) {
  ADIT_SHARED_DATA_OR_SKIP(folder, "evaluation_kitti_00");
  const std::filesystem::path times = folder / "KITTI_00_gt_times.txt";
  const Evaluation result = evaluate(read_trajectory(folder / "KITTI_00_ORB.txt", times),
                                     read_trajectory(folder / "KITTI_00_gt.txt", times), {});
  EXPECT_TRUE(result.association.by_time);
  EXPECT_EQ(result.association.pairs, 4541U);
  EXPECT_NEAR(result.ate.rmse, 1.303450, kSixDecimals);
}

}  // namespace
}  // namespace adit
