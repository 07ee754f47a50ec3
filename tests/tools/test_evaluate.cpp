// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

Vector6d twist(double x, double y, double z, double a, double b, double c) {
  Vector6d xi;
  xi << x, y, z, a, b, c;
  return xi;
}

/// A winding path with one pose every 0.1 s.
Trajectory winding_path(std::size_t poses) {
  Trajectory result;
  result.file = "truth.tum";
  result.stamped = true;
  Eigen::Isometry3d pose = se3_exp(twist(5, -3, 2, 0.3, -0.2, 1.0));
  for (std::size_t i = 0; i < poses; ++i) {
    result.poses.push_back({std::chrono::milliseconds(100 * i), pose});
    const double s = static_cast<double>(i);
    pose = pose * se3_exp(twist(1.0, 0.0, 0.1 * std::sin(0.05 * s), 0.002, 0.003,
                                0.03 * std::cos(0.02 * s)));
  }
  return result;
}

Trajectory moved(const Trajectory& trajectory, const Similarity& motion) {
  Trajectory result = trajectory;
  result.file = "estimate.tum";
  for (StampedPose& pose : result.poses) {
    pose.pose = motion * pose.pose;
  }
  return result;
}

Similarity some_motion(double scale = 1.0) {
  const Eigen::Isometry3d pose = se3_exp(twist(100, -20, 7, 1.0, -2.0, 0.5));
  return {pose.linear(), pose.translation(), scale};
}

EvaluationOptions with_alignment(Alignment alignment) {
  EvaluationOptions options;
  options.alignment = alignment;
  return options;
}

TEST(Statistics, OfAKnownList) {
  const Statistics s = statistics(std::vector<double>{3.0, 1.0, 2.0, 6.0});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.mean, 3.0);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.sse, 50.0);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(3.5));
  EXPECT_DOUBLE_EQ(s.min, 1.0);
  EXPECT_DOUBLE_EQ(s.max, 6.0);
  EXPECT_EQ(statistics(std::vector<double>{3.0, 1.0, 2.0}).median, 2.0);
  EXPECT_EQ(statistics({}).count, 0U);
}

TEST(Umeyama, FindsTheMotionAndTheScale) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> from(50);
  std::vector<Eigen::Vector3d> to(50);
  const Similarity motion = some_motion(1.7);
  for (std::size_t i = 0; i < from.size(); ++i) {
    from[i] = 30.0 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    to[i] = motion.scale * (motion.rotation * from[i]) + motion.translation;
  }
  const Similarity found = umeyama(from, to, true).value();
  EXPECT_LT((found.rotation - motion.rotation).norm(), 1e-13);
  EXPECT_LT((found.translation - motion.translation).norm(), 1e-11);
  EXPECT_NEAR(found.scale, 1.7, 1e-13);
  EXPECT_EQ(umeyama(from, to, false)->scale, 1.0);
}

TEST(Umeyama, IsTheMinimum) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> from(20);
  std::vector<Eigen::Vector3d> to(20);
  for (std::size_t i = 0; i < from.size(); ++i) {
    from[i] = Eigen::Vector3d(normal(random), normal(random), normal(random));
    to[i] = from[i] + 0.5 * Eigen::Vector3d(normal(random), normal(random), normal(random));
  }
  const auto cost = [&](const Similarity& s) {
    double sum = 0.0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      sum += (s.scale * (s.rotation * from[i]) + s.translation - to[i]).squaredNorm();
    }
    return sum;
  };
  const Similarity best = umeyama(from, to, true).value();
  for (int i = 0; i < 7; ++i) {
    for (const double step : {-1e-3, 1e-3}) {
      Similarity other = best;
      if (i < 3) {
        other.rotation = best.rotation * so3_exp(step * Eigen::Vector3d::Unit(i));
      } else if (i < 6) {
        other.translation += step * Eigen::Vector3d::Unit(i - 3);
      } else {
        other.scale += step;
      }
      EXPECT_GT(cost(other), cost(best));
    }
  }
}

TEST(Umeyama, NeverMirrors) {
  // A mirrored cloud: the best orthogonal matrix is a reflection, the answer must be a rotation.
  const std::vector<Eigen::Vector3d> from = {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {-1, -1, -1}};
  std::vector<Eigen::Vector3d> to;
  for (const Eigen::Vector3d& p : from) {
    to.emplace_back(p.x(), p.y(), -p.z());
  }
  EXPECT_NEAR(umeyama(from, to, false)->rotation.determinant(), 1.0, 1e-14);
}

TEST(Umeyama, PositionsInAPlaneSuffice) {
  const std::vector<Eigen::Vector3d> from = {{1, 0, 0}, {0, 2, 0}, {3, 1, 0}};
  const Similarity motion = some_motion();
  std::vector<Eigen::Vector3d> to;
  for (const Eigen::Vector3d& p : from) {
    to.emplace_back(motion.rotation * p + motion.translation);
  }
  EXPECT_LT((umeyama(from, to, false)->rotation - motion.rotation).norm(), 1e-13);
}

TEST(Umeyama, PositionsOnALineOrInOnePlaceDoNot) {
  const std::vector<Eigen::Vector3d> line = {{1, 2, 3}, {2, 4, 6}, {3, 6, 9}, {-1, -2, -3}};
  const std::vector<Eigen::Vector3d> place(4, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(umeyama(line, line, false));
  EXPECT_FALSE(umeyama(place, place, false));
  EXPECT_FALSE(umeyama(std::span(line).first(2), std::span(line).first(2), false));
}

TEST(Associate, NearestInTimeWithinTheTolerance) {
  const Trajectory truth = winding_path(10);
  Trajectory estimate = truth;
  estimate.poses.resize(4);
  estimate.poses[0].stamp = std::chrono::milliseconds(-20);  // too far from 0
  estimate.poses[1].stamp = std::chrono::milliseconds(104);
  estimate.poses[2].stamp = std::chrono::milliseconds(190);  // exactly the tolerance
  estimate.poses[3].stamp = std::chrono::milliseconds(450);  // between 400 and 500
  const Association result = associate(estimate, truth, 0.01);
  ASSERT_EQ(result.pairs.size(), 2U);
  EXPECT_EQ(result.pairs[0].estimate, 1U);
  EXPECT_EQ(result.pairs[0].truth, 1U);
  EXPECT_EQ(result.pairs[1].estimate, 2U);
  EXPECT_EQ(result.pairs[1].truth, 2U);
  EXPECT_DOUBLE_EQ(result.summary.largest_difference, 0.01);
  EXPECT_NEAR(result.summary.covered_path / result.summary.truth_path, 1.0 / 9.0, 0.01);
}

TEST(Associate, ThePosesOfTheShorterOneAreLookedUp) {
  Trajectory truth = winding_path(2);
  const Trajectory estimate = winding_path(20);
  truth.poses[1].stamp = std::chrono::milliseconds(1000);
  const Association result = associate(estimate, truth, 0.01);
  ASSERT_EQ(result.pairs.size(), 2U);
  EXPECT_EQ(result.pairs[1].estimate, 10U);
  EXPECT_EQ(result.pairs[1].truth, 1U);
}

TEST(Associate, ByIndexWhereTimesAreMissing) {
  Trajectory truth = winding_path(5);
  truth.stamped = false;
  const Association result = associate(winding_path(3), truth, 0.01);
  EXPECT_FALSE(result.summary.by_time);
  EXPECT_EQ(result.pairs.size(), 3U);
}

TEST(Associate, NoPairIsAnErrorThatShowsBothTimes) {
  const Trajectory truth = winding_path(5);
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate.poses) {
    pose.stamp += std::chrono::hours(1);
  }
  try {
    associate(estimate, truth, 0.01);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("3600.000000 to 3600.400000 s"), std::string::npos)
        << error.found();
    EXPECT_NE(error.found().find("0.000000 to 0.400000 s"), std::string::npos) << error.found();
  }
}

TEST(Evaluate, MotionOfTheWholeIsAlignedAway) {
  const Trajectory truth = winding_path(300);
  const Evaluation result = evaluate(moved(truth, some_motion()), truth, {});
  EXPECT_LT(result.ate.max, 1e-11);
  EXPECT_LT(result.ate_rotation.max, 1e-6);
  EXPECT_LT(result.rpe.translation.max, 1e-11);
  EXPECT_GT(result.ate_unaligned.min, 1.0);
  EXPECT_LT(result.all_segments.translation, 1e-12);
  EXPECT_TRUE(result.warnings.empty());
}

TEST(Evaluate, PartsThatNothingTiesTogetherAreNotAlignedTogether) {
  const Trajectory truth = winding_path(300);
  Trajectory estimate = moved(truth, some_motion());
  const Trajectory elsewhere = moved(truth, some_motion(1.1));
  std::copy(elsewhere.poses.begin() + 200, elsewhere.poses.end(), estimate.poses.begin() + 200);
  estimate.parts = {200};
  try {
    evaluate(estimate, truth, {});
    FAIL() << "aligned across";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("--part"), std::string::npos) << error.what();
  }
  const Evaluation first = evaluate(estimate, truth, {.rpe = {}, .part = 1});
  EXPECT_EQ(first.association.pairs, 200U);
  EXPECT_LT(first.ate.max, 1e-10);
  EXPECT_GT(evaluate(estimate, truth, {.rpe = {}, .part = 2}).ate.max, 0.1) << "its scale is wrong";
  EXPECT_GT(evaluate(estimate, truth, {.rpe = {}, .across_parts = true}).ate.max, 0.1);
  EXPECT_NO_THROW(evaluate(estimate, truth, with_alignment(Alignment::none)));
  EXPECT_THROW(evaluate(estimate, truth, {.rpe = {}, .part = 3}), InputError);
  EXPECT_THROW(evaluate(estimate, truth, {.rpe = {}, .part = 0}), InputError);
}

TEST(Evaluate, ScaleIsAlignedAwayBySim3Only) {
  const Trajectory truth = winding_path(300);
  const Trajectory estimate = moved(truth, some_motion(0.9));
  EXPECT_LT(evaluate(estimate, truth, with_alignment(Alignment::sim3)).ate.max, 1e-11);
  EXPECT_NEAR(evaluate(estimate, truth, with_alignment(Alignment::sim3)).alignment.scale, 1.0 / 0.9,
              1e-12);
  EXPECT_GT(evaluate(estimate, truth, with_alignment(Alignment::se3)).ate.rmse, 1.0);
}

TEST(Evaluate, OriginMakesTheFirstPosesEqual) {
  const Trajectory truth = winding_path(100);
  Trajectory estimate = moved(truth, some_motion());
  estimate.poses.back().pose.translation() += Eigen::Vector3d(3, 4, 0);
  const Evaluation result = evaluate(estimate, truth, with_alignment(Alignment::origin));
  EXPECT_LT(result.position_errors.front(), 1e-11);
  EXPECT_NEAR(result.ate.max, 5.0, 1e-10);
  EXPECT_LT(result.ate.median, 1e-11);
}

TEST(Evaluate, ErrorsThatWerePutInComeOut) {
  const Trajectory truth = winding_path(200);
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < estimate.poses.size(); i += 2) {
    Eigen::Isometry3d& pose = estimate.poses[i].pose;
    pose.translation().z() += 0.5;
    pose.linear() = pose.linear() * so3_exp(Eigen::Vector3d(std::numbers::pi / 180.0, 0.0, 0.0));
  }
  const Evaluation result = evaluate(estimate, truth, with_alignment(Alignment::none));
  EXPECT_NEAR(result.ate.mean, 0.25, 1e-12);
  EXPECT_NEAR(result.ate.rmse, 0.5 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(result.ate_rotation.max, 1.0, 1e-10);
  EXPECT_NEAR(result.ate_rotation.mean, 0.5, 1e-10);
}

TEST(Evaluate, StraightLineAsksForAnotherAlignment) {
  Trajectory truth = winding_path(10);
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    truth.poses[i].pose.translation() = Eigen::Vector3d(static_cast<double>(i), 0, 0);
  }
  try {
    evaluate(truth, truth, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.remedy().find("--align origin"), std::string::npos);
  }
  EXPECT_EQ(evaluate(truth, truth, with_alignment(Alignment::origin)).ate.count, 10U);
}

TEST(Evaluate, UnequalNumbersMatchedByIndexAreWarnedOf) {
  Trajectory truth = winding_path(50);
  truth.stamped = false;
  Trajectory estimate = winding_path(40);
  EXPECT_EQ(evaluate(estimate, truth, {}).warnings.size(), 1U);
}

/// Each pose twice, the second `apart` (m) along x.
Trajectory doubled(const Trajectory& trajectory, double apart) {
  Trajectory result = trajectory;
  result.poses.clear();
  for (const StampedPose& pose : trajectory.poses) {
    result.poses.push_back(pose);
    result.poses.push_back(pose);
    result.poses.back().pose.translation().x() += apart;
  }
  return result;
}

TEST(Evaluate, RepeatedTimesAreAllComparedAndWarnedOf) {
  const Trajectory truth = winding_path(50);
  for (const std::size_t more : {0U, 100U}) {  // the estimate is longer, or shorter
    Trajectory reference = truth;
    for (std::size_t i = 0; i < more; ++i) {
      reference.poses.push_back(reference.poses.back());
      reference.poses.back().stamp += std::chrono::milliseconds(100);
    }
    const Evaluation result =
        evaluate(doubled(truth, 5.0), reference, with_alignment(Alignment::none));
    EXPECT_EQ(result.association.pairs, 100U);
    EXPECT_NEAR(result.ate.max, 5.0, 1e-9);
    EXPECT_EQ(result.association.estimate_stamps.repeated, 50U);
    ASSERT_EQ(result.warnings.size(), 1U) << more;
    EXPECT_NE(result.warnings[0].find("50 of the estimate's 100 poses have the time of the pose "
                                      "before, and 50 of these are other poses, up to 5.000 m"),
              std::string::npos)
        << result.warnings[0];
  }
  const Evaluation same = evaluate(doubled(truth, 0.0), truth, {});
  ASSERT_EQ(same.warnings.size(), 1U);
  EXPECT_NE(same.warnings[0].find("are the same poses"), std::string::npos);
  const Evaluation of_truth = evaluate(truth, doubled(truth, 5.0), {});
  EXPECT_LT(of_truth.ate.max, 1e-6);
  ASSERT_EQ(of_truth.warnings.size(), 1U);
  EXPECT_NE(of_truth.warnings[0].find("the first of each time is compared"), std::string::npos);
}

TEST(Evaluate, TimesThatWereRoundedAwayAreRefused) {
  const Trajectory truth = winding_path(50);
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate.poses) {
    pose.stamp = truth.poses.front().stamp;  // as "%g" leaves 1.7e+09
  }
  try {
    evaluate(estimate, truth, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.found().find("50 poses have 1 different times"), std::string::npos)
        << error.found();
    EXPECT_NE(error.remedy().find("%.9f"), std::string::npos);
  }
}

TEST(Evaluate, CoarseTimesAreNamedWhereTheyCostPairsOrRepeat) {
  Trajectory truth = winding_path(500);
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    truth.poses[i].stamp = std::chrono::milliseconds(7 + 37 * static_cast<int>(i));
  }
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate.poses) {
    const auto tenths = std::chrono::round<std::chrono::milliseconds>(pose.stamp).count() / 100;
    pose.stamp = std::chrono::milliseconds(100 * tenths);
  }
  EXPECT_THROW(evaluate(estimate, truth, {}), InputError);  // most of its poses share a time
  Trajectory half = estimate;
  half.poses.clear();
  for (std::size_t i = 0; i < estimate.poses.size(); i += 2) {
    half.poses.push_back(estimate.poses[i]);
  }
  EvaluationOptions options;
  options.tolerance = 0.02;
  const Evaluation result = evaluate(half, truth, options);
  EXPECT_TRUE(std::ranges::any_of(result.warnings, [](const std::string& warning) {
    return warning.find("the estimate's times were written to 0.1 s only") != warning.npos;
  }));
}

TEST(Evaluate, PairsThatShareAPoseAreWarnedOf) {
  const Trajectory truth = winding_path(50);
  Trajectory estimate = truth;
  for (const StampedPose& pose : truth.poses) {
    estimate.poses.push_back(pose);
    estimate.poses.back().stamp += std::chrono::milliseconds(4);
  }
  std::ranges::sort(estimate.poses, {}, &StampedPose::stamp);
  Trajectory longer = truth;
  for (int i = 0; i < 100; ++i) {
    longer.poses.push_back(longer.poses.back());
    longer.poses.back().stamp += std::chrono::milliseconds(100);
  }
  const Evaluation result = evaluate(estimate, longer, {});
  EXPECT_EQ(result.association.shared_truth, 50U);
  ASSERT_EQ(result.warnings.size(), 1U);
  EXPECT_NE(result.warnings[0].find("50 of 100 pairs share their pose of the truth"),
            std::string::npos);
}

TEST(Evaluate, PoorCoverageIsWarnedOf) {
  const Trajectory truth = winding_path(50);
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < 20; ++i) {
    estimate.poses[i].stamp += std::chrono::milliseconds(50);
  }
  EXPECT_EQ(evaluate(estimate, truth, {}).warnings.size(), 1U);
}

}  // namespace
}  // namespace adit
