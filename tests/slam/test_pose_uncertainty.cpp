// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/pose_uncertainty.hpp"

#include <chrono>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace adit {
namespace {

Eigen::Isometry3d ahead(double distance, double turn = 0.0) {
  Vector6d xi;
  xi << distance, 0.0, 0.0, 0.0, 0.0, turn;
  return se3_exp(xi);
}

Matrix6d of_sigma(double translation, double rotation) {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(translation * translation),
      Eigen::Vector3d::Constant(rotation * rotation);
  return variance.asDiagonal();
}

TEST(PoseUncertainty, CloudsThatJoinHandTheirErrorOn) {
  DriftModel model;
  const Matrix6d local = of_sigma(0.01, 0.001);
  EXPECT_TRUE(model.update(ahead(0.0), Matrix6d::Zero(), true).drift.isZero());
  EXPECT_TRUE(model.update(ahead(0.0), local, true).drift.isZero()) << "it has not joined yet";
  const PoseUncertainty first = model.update(ahead(0.0), local, false);
  const PoseUncertainty stays = model.update(ahead(0.0), local, false);
  EXPECT_TRUE(first.drift.isApprox(0.15 * local));
  EXPECT_TRUE(stays.drift.isApprox(first.drift));
  EXPECT_TRUE(stays.in_map().isApprox(stays.drift + local));
}

// Ahead, where a sweep is known to 6 cm, its cloud is what the next one is known by to 1 cm: in the
// map it is known no better than to 6. To the side nothing has changed.
TEST(PoseUncertainty, NothingIsKnownBetterByACloudThanThatIsItself) {
  Matrix6d before = of_sigma(0.01, 0.001);
  before(0, 0) = 0.06 * 0.06;
  before(0, 5) = before(5, 0) = 0.5 * 0.06 * 0.001;
  DriftModel model;
  model.update(ahead(0.0), before, true);
  const PoseUncertainty after = model.update(ahead(0.5), of_sigma(0.01, 0.001), false);
  EXPECT_NEAR(std::sqrt(after.in_map()(0, 0)), 0.06, 0.003);
  EXPECT_NEAR(after.drift(1, 1), 0.15 * 0.01 * 0.01, 1e-5);

  DriftModel other;  // known worse, or gone: what is usual
  other.update(ahead(0.0), of_sigma(0.01, 0.001), true);
  EXPECT_NEAR(other.update(ahead(0.0), before, false).drift(0, 0), 0.15 * 1e-4, 1e-6);
  DriftModel exact;
  exact.update(ahead(0.0), of_sigma(0.01, 0.001), true);
  EXPECT_NEAR(exact.update(ahead(0.0), Matrix6d::Zero(), false).drift(0, 0), 0.15 * 1e-4, 1e-9);
}

// It may have moved, for all that matches hold; then the readings tell that it has not.
TEST(PoseUncertainty, WhoRestedHasNotDrifted) {
  DriftModel model;
  const Matrix6d may_have = of_sigma(0.4, 0.1);
  model.update(ahead(0.0), Matrix6d::Zero(), false);
  const PoseUncertainty waiting = model.update(ahead(0.0), Matrix6d::Zero(), false, may_have);
  EXPECT_TRUE(waiting.drift.isApprox(may_have));
  model.update(ahead(0.0), of_sigma(0.2, 0.02), true);
  model.note_rest();
  const PoseUncertainty rested = model.update(ahead(0.0), of_sigma(0.01, 0.001), false);
  EXPECT_TRUE(rested.drift.isZero());
  // Nor has it moved since, by less than nothing.
  const Matrix6d motion = motion_covariance({Nanoseconds(0), ahead(0.0), waiting},
                                            {std::chrono::seconds(9), ahead(0.0), rested});
  EXPECT_TRUE(motion.isApprox(of_sigma(0.01, 0.001), 1e-4));
  const PoseUncertainty moves = model.update(ahead(0.1), Matrix6d::Zero(), false, may_have);
  EXPECT_GT(moves.drift(0, 0), 0.1) << "from now on";
}

TEST(PoseUncertainty, AnAttitudeThatDriftedMovesWhatIsFarAhead) {
  DriftModel model;
  model.update(ahead(0.0), of_sigma(0.0, 0.01), true);
  const Matrix6d there = model.update(ahead(100.0), Matrix6d::Zero(), false).drift;
  const Matrix6d by_the_way = DriftModel().update(ahead(0.0), Matrix6d::Zero(), false).drift;
  EXPECT_TRUE(by_the_way.isZero());
  EXPECT_NEAR(there(1, 1), 1e4 * 0.15 * 1e-4, 0.01);
  EXPECT_NEAR(there(0, 0), 0.0, 1e-4);
}

// A tunnel along x, where nothing else measures: as time^1.5, along x alone, and for good.
TEST(PoseUncertainty, WhatNoMatchHoldsWalksAway) {
  RegistrationResult tunnel;
  for (ObservedDirection& direction : tunnel.translation) {
    direction.localizability = Localizability::full;
  }
  for (ObservedDirection& direction : tunnel.rotation) {
    direction.localizability = Localizability::full;
  }
  const Matrix6d held = unheld_directions(tunnel);
  EXPECT_TRUE(held.isZero());
  tunnel.translation[0] = {.axis = Eigen::Vector3d::UnitX(),
                           .localizability = Localizability::none};
  const Matrix6d unheld = unheld_directions(tunnel);

  const auto sigmas = [&](double lasts, double turn) {
    UnmeasuredMotion motion;
    DriftModel drift;
    Matrix6d covariance = Matrix6d::Zero();
    for (int i = 0; i <= 200; ++i) {
      const StampedPose pose{nanoseconds(0.1 * i), ahead(0.1 * i, turn)};
      const bool inside = 0.1 * i > 1e-9 && 0.1 * i < lasts + 1e-9;
      // The tunnel's axis stays where it is, however the lidar is turned in it.
      Matrix6d seen = inside ? unheld : held;
      const Eigen::Matrix3d R = ahead(0.0, turn).linear();
      seen.topLeftCorner<3, 3>() = (R.transpose() * seen.topLeftCorner<3, 3>() * R).eval();
      covariance =
          drift.update(pose.pose, Matrix6d::Zero(), false, motion.step(pose, pose.pose, seen))
              .drift;
    }
    const Eigen::Matrix3d R = ahead(0.0, turn).linear();
    return Eigen::Vector3d(
        (R * covariance.topLeftCorner<3, 3>() * R.transpose()).diagonal().cwiseSqrt());
  };
  EXPECT_LT(sigmas(0.0, 0.0).x(), 0.01);
  EXPECT_NEAR(sigmas(1.0, 0.0).x(), 1.0 / std::sqrt(3.0), 0.1);
  EXPECT_NEAR(sigmas(2.0, 0.0).x() / sigmas(1.0, 0.0).x(), std::sqrt(8.0), 0.5);
  EXPECT_GT(sigmas(10.0, 0.0).x(), 6.0);
  EXPECT_LT(sigmas(10.0, 0.0).tail<2>().maxCoeff(), 0.05);
  EXPECT_NEAR(sigmas(10.0, 0.7).x(), sigmas(10.0, 0.0).x(), 1e-4);
  EXPECT_LT(sigmas(10.0, 0.7).tail<2>().maxCoeff(), 0.05);
}

// Who turns by 3 rad/s, and within the next tenth of a second the other way, was not seen turning.
TEST(PoseUncertainty, StepsThatNoSensorMakesAreNotBelieved) {
  const auto added = [](double elapsed, double distance, double turn) {
    UnmeasuredMotion motion;
    Matrix6d covariance = Matrix6d::Zero();
    for (int i = 0; i < 3; ++i) {
      covariance =
          motion.step({nanoseconds(0.1 * i), ahead(0.1 * i)}, ahead(0.1 * i), Matrix6d::Zero());
      EXPECT_TRUE(covariance.isZero());
      EXPECT_FALSE(motion.leapt());
    }
    const Eigen::Isometry3d steady = ahead(0.2 + elapsed);
    covariance = motion.step({nanoseconds(0.2 + elapsed), steady * ahead(distance, turn)}, steady,
                             Matrix6d::Zero());
    EXPECT_EQ(motion.leapt(), !covariance.isZero());
    return covariance;
  };
  EXPECT_TRUE(added(0.1, 0.1, 0.15).isZero());  // fast hands
  EXPECT_TRUE(added(0.2, 0.3, 0.5).isZero());   // past a sweep that was not aligned
  const Matrix6d leapt = added(0.1, 1.3, 0.9);
  EXPECT_NEAR(leapt(5, 5), 0.81, 1e-9);
  EXPECT_NEAR(leapt(0, 0), 1.69, 1e-9);
  EXPECT_NEAR(leapt(3, 3), 0.0, 1e-12);
  // The second step is held against nothing: how fast the sensor is, is not known yet.
  UnmeasuredMotion begins;
  begins.step({nanoseconds(0.0), ahead(0.0)}, ahead(0.0), Matrix6d::Zero());
  EXPECT_TRUE(begins.step({nanoseconds(0.1), ahead(2.0)}, ahead(0.0), Matrix6d::Zero()).isZero());
}

// Sweeps of a car at 20 m/s, a tenth of a second apart, with stamps rounded to 10 ms.
TEST(PoseUncertainty, RoundedStampsAreNoSteps) {
  const auto count_leaps = [](double wrong) {
    UnmeasuredMotion motion;
    int leaps = 0;
    std::vector<StampedPose> poses;
    for (size_t i = 0; i < 50; ++i) {
      const double time = 0.1034 * static_cast<double>(i);
      poses.push_back({nanoseconds(0.01 * std::round(100.0 * time)),
                       ahead(20.0 * time + (i == 25 ? wrong : 0.0))});
      Eigen::Isometry3d steady = poses.back().pose;
      if (i > 1) {
        const double before = seconds(poses[i - 1].stamp - poses[i - 2].stamp);
        const double now = seconds(poses[i].stamp - poses[i - 1].stamp);
        const double way = (poses[i - 1].pose.translation() - poses[i - 2].pose.translation()).x();
        steady = poses[i - 1].pose * ahead(way * now / before);
      }
      motion.step(poses.back(), steady, Matrix6d::Zero());
      leaps += motion.leapt() ? 1 : 0;
    }
    return leaps;
  };
  EXPECT_EQ(count_leaps(0.0), 0);
  EXPECT_GE(count_leaps(0.8), 2);
}

// Errors that are a sensor's own, in no covariance of an alignment: a tenth of a degree in 25 m.
TEST(PoseUncertainty, WaysAndTurnsLeaveWhatNoSweepTells) {
  const auto after = [](int steps, double turn) {
    DriftModel model;
    PoseUncertainty uncertainty;
    for (int i = 0; i <= steps; ++i) {
      uncertainty = model.update(ahead(1.0 * i, turn * i), Matrix6d::Zero(), false);
    }
    return uncertainty.drift;
  };
  EXPECT_NEAR(std::sqrt(after(25, 0.0)(5, 5)), 0.00175, 1e-5);
  EXPECT_NEAR(std::sqrt(after(100, 0.0)(5, 5)), 0.0035, 1e-5);
  EXPECT_GE(std::sqrt(after(100, 0.0)(1, 1)), 0.1) << "what has turned is off ahead";
  EXPECT_LE(std::sqrt(after(100, 0.0)(0, 0)), 0.01);
  EXPECT_GT(after(25, 0.1)(5, 5), after(25, 0.0)(5, 5));
  EXPECT_TRUE(after(0, 1.0).isZero());
}

TEST(PoseUncertainty, PosesAMomentApartErrAlike) {
  const auto share = [](std::chrono::milliseconds apart) {
    const PoseUncertainty uncertainty{.local = of_sigma(0.01, 0.001)};
    return motion_covariance({Nanoseconds(0), ahead(0.0), uncertainty},
                             {apart, ahead(0.0), uncertainty})(0, 0) /
           (2.0 * uncertainty.local(0, 0));
  };
  using std::chrono::milliseconds;
  EXPECT_NEAR(share(milliseconds(0)), 0.0, 1e-12);
  EXPECT_NEAR(share(milliseconds(100)), 0.12, 0.01);
  EXPECT_GE(share(milliseconds(1000)), 0.7);
  EXPECT_NEAR(share(milliseconds(10'000)), 1.0, 1e-5);
}

// A submap that moves by a random error whenever a cloud joins, and sweeps that err in it: both
// covariances against the errors of many such walks.
TEST(PoseUncertainty, MotionsOfRandomWalksAreAsUncertainAsTold) {
  constexpr int kRuns = 2000;
  constexpr double kKept = 0.15;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const Matrix6d local = of_sigma(0.01, 0.002);
  const auto error = [&](double share) {
    return Vector6d(std::sqrt(share) * Vector6d(local.diagonal().cwiseSqrt().cwiseProduct(
                                           Vector6d::NullaryExpr([&] { return normal(random); }))));
  };
  double motion = 0.0;
  double map = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    DriftModel model;
    Eigen::Isometry3d T_map_world = Eigen::Isometry3d::Identity();
    UncertainPose from;
    UncertainPose to;
    for (int i = 0; i <= 10; ++i) {
      const Eigen::Isometry3d truth = ahead(0.8 * i, 0.1 * i);
      if (i > 0) {  // what the way to here leaves
        const double metres =
            (truth.translation() - ahead(0.8 * (i - 1), 0.1 * (i - 1)).translation()).norm();
        Vector6d way = Vector6d::NullaryExpr([&] { return normal(random); });
        way.head<3>() *= 0.0007 * std::sqrt(metres);
        way.tail<3>() *= std::sqrt(std::pow(0.00035, 2) * metres + std::pow(0.001, 2) * 0.1);
        T_map_world = retract(T_map_world * truth, way) * truth.inverse();
      }
      const PoseUncertainty uncertainty = model.update(truth, local, true);
      to = {.stamp = std::chrono::seconds(i),
            .T_map_lidar = retract(T_map_world * truth, error(1.0)),
            .uncertainty = uncertainty};
      from = i == 4 ? to : from;
      T_map_world = retract(T_map_world * truth, error(kKept)) * truth.inverse();
    }
    const auto squared = [](const Eigen::Isometry3d& off, const Matrix6d& covariance) {
      const Vector6d e = se3_log(off);
      return e.dot(covariance.ldlt().solve(e));
    };
    const Eigen::Isometry3d T_from_to = ahead(3.2, 0.4).inverse() * ahead(8.0, 1.0);
    motion += squared(T_from_to.inverse() * from.T_map_lidar.inverse() * to.T_map_lidar,
                      motion_covariance(from, to));
    map += squared(ahead(8.0, 1.0).inverse() * to.T_map_lidar, to.uncertainty.in_map());
  }
  EXPECT_NEAR(motion / kRuns, 6.0, 0.3);
  EXPECT_NEAR(map / kRuns, 6.0, 0.3);
}

TEST(PoseUncertainty, WhatARestartLacksAllAfterItLack) {
  DriftModel model;
  model.update(ahead(0.0), of_sigma(0.01, 0.001), true);
  model.update(ahead(1.0), Matrix6d::Zero(), false);
  const PoseUncertainty restarted = model.restart(of_sigma(0.5, 0.1));
  EXPECT_TRUE(restarted.local.isZero());
  EXPECT_TRUE(restarted.in_map().isApprox(of_sigma(0.5, 0.1), 1e-4));
  EXPECT_GE(model.update(ahead(1.0), Matrix6d::Zero(), false).drift(0, 0), 0.25);
}

}  // namespace
}  // namespace adit
