// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/motion_shares.hpp"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

constexpr int kLedgerState = kStateSize;
constexpr int kLedgerSteps = 6;

class ShareDraw {
 public:
  explicit ShareDraw(uint64_t seed) : engine_(seed) {}
  double operator()() { return normal_(engine_); }

  LinkQuadratic link(int rows) {
    LinkQuadratic sum;
    for (int i = 0; i < rows; ++i) {
      LinkFactor<1> factor;
      factor.by_from = StateVector::NullaryExpr([&] { return (*this)(); }).transpose();
      factor.by_to = StateVector::NullaryExpr([&] { return (*this)(); }).transpose();
      sum += quadratic(factor);
    }
    return sum;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

NavState state_of_step(int i) {
  NavState state;
  state.T_map_body.translation() = Eigen::Vector3d(10.0 * i, 2.0 * i * i, 0.3 * i);
  state.T_map_body.linear() = so3_exp({0.1 * i, -0.05 * i, 0.4 * i});
  state.gravity_map = Eigen::Vector3d(0.3, -0.2, -9.8);
  return state;
}

StepInformation drawn_step(ShareDraw& draw) {
  StepInformation step;
  StateFactor<6> pose;
  pose.by_state.leftCols<6>() = Matrix6d::NullaryExpr([&] { return draw(); });
  step.range = quadratic(pose);
  step.imu = draw.link(kLedgerState);
  step.velocity = draw.link(3);
  step.doppler = draw.link(2);
  return step;
}

/// Information of all states by one source.
class SourceInformation {
 public:
  void add(int i, const StateMatrix& h) {
    all.block<kLedgerState, kLedgerState>(kLedgerState * i, kLedgerState * i) += h;
  }
  void add(int to, const LinkQuadratic& link) {
    add(to - 1, link.h_from);
    add(to, link.h_to);
    all.block<kLedgerState, kLedgerState>(kLedgerState * to - kLedgerState, kLedgerState * to) +=
        link.h_cross;
    all.block<kLedgerState, kLedgerState>(kLedgerState * to, kLedgerState * to - kLedgerState) +=
        link.h_cross.transpose();
  }

  Eigen::MatrixXd all =
      Eigen::MatrixXd::Zero(kLedgerState * kLedgerSteps, kLedgerState* kLedgerSteps);
};

/// Derivative of the last motion's translation, of a direction in the later body's axes, by all
/// states: by differences.
Eigen::VectorXd motion_by_states(const NavState& from, const NavState& to,
                                 const Eigen::Vector3d& axis) {
  Eigen::VectorXd by = Eigen::VectorXd::Zero(kLedgerState * kLedgerSteps);
  const Eigen::Isometry3d T = from.T_map_body.inverse() * to.T_map_body;
  for (int k = 0; k < 6; ++k) {
    StateVector step = StateVector::Zero();
    step[k] = 1e-6;
    const auto moved = [&](const Eigen::Isometry3d& there) {
      return axis.dot((T.inverse() * there).translation()) / 1e-6;
    };
    by[kLedgerState * (kLedgerSteps - 2) + k] =
        moved(retract(from, step).T_map_body.inverse() * to.T_map_body);
    by[kLedgerState * (kLedgerSteps - 1) + k] =
        moved(from.T_map_body.inverse() * retract(to, step).T_map_body);
  }
  return by;
}

TEST(MotionShares, AreThoseOfAllStatesTogether) {
  ShareDraw draw(7);
  std::array<SourceInformation, kMotionSources> dense;
  const auto of = [&](MotionSource source) -> SourceInformation& {
    return dense[static_cast<std::size_t>(source)];
  };
  MotionLedger ledger;
  const StateMatrix prior = 5.0 * StateMatrix::Identity();
  ledger.start(prior);
  of(MotionSource::start).add(0, prior);
  std::optional<MotionShares> shares;
  for (int i = 1; i < kLedgerSteps; ++i) {
    const StepInformation step = drawn_step(draw);
    of(MotionSource::range).add(i, step.range.h);
    of(MotionSource::imu).add(i, step.imu);
    of(MotionSource::velocity).add(i, step.velocity);
    of(MotionSource::doppler).add(i, step.doppler);
    shares = ledger.add(step, state_of_step(i - 1), state_of_step(i));
    ASSERT_TRUE(shares) << i;
  }

  Eigen::MatrixXd sum =
      Eigen::MatrixXd::Zero(kLedgerState * kLedgerSteps, kLedgerState * kLedgerSteps);
  for (const SourceInformation& one : dense) {
    sum += one.all;
  }
  const Eigen::MatrixXd covariance = sum.inverse();
  const NavState from = state_of_step(kLedgerSteps - 2);
  const NavState to = state_of_step(kLedgerSteps - 1);
  const Eigen::Vector3d up = -to.gravity_map.normalized();
  Eigen::Vector3d along = to.T_map_body.translation() - from.T_map_body.translation();
  along = (along - up.dot(along) * up).normalized();
  ASSERT_TRUE(shares->moved);
  const std::array<Eigen::Vector3d, 3> axes = {along, up.cross(along), up};
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const Eigen::VectorXd d =
        covariance * motion_by_states(from, to, to.T_map_body.linear().transpose() * axes[k]);
    double total = 0.0;
    for (std::size_t i = 0; i < kMotionSources; ++i) {
      const double expected = d.dot(dense[i].all * d) / d.dot(sum * d);
      EXPECT_NEAR(shares->of[i][k], expected, 1e-4) << i << " " << k;
      EXPECT_GE(shares->of[i][k], 0.0);
      total += shares->of[i][k];
    }
    EXPECT_NEAR(total, 1.0, 1e-9) << k;
  }
  double turns = 0.0;
  for (std::size_t i = 0; i < kMotionSources; ++i) {
    turns += shares->of[i][3];
  }
  EXPECT_NEAR(turns, 1.0, 1e-9);
}

TEST(MotionShares, AtRestThereIsNoPath) {
  ShareDraw draw(8);
  MotionLedger ledger;
  ledger.start(StateMatrix::Identity());
  const auto shares = ledger.add(drawn_step(draw), state_of_step(1), state_of_step(1));
  ASSERT_TRUE(shares);
  EXPECT_FALSE(shares->moved);
  EXPECT_EQ((*shares)(MotionSource::imu, MotionPart::along), 0.0);
  EXPECT_GT((*shares)(MotionSource::imu, MotionPart::up), 0.0);
}

TEST(MotionShares, WhatDoesNotDetermineTheMotionHasNone) {
  MotionLedger ledger;
  EXPECT_FALSE(ledger.add({}, state_of_step(0), state_of_step(1))) << "before a start";
  ledger.start(StateMatrix::Identity());
  EXPECT_FALSE(ledger.add({}, state_of_step(0), state_of_step(1)));
}

}  // namespace
}  // namespace adit
