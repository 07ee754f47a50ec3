// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "adit/shaders/shared/registration.h"
#include "adit/slam/registration/registration.hpp"

namespace adit {
namespace {

Eigen::Isometry3d some_pose() {
  Vector6d xi;
  xi << 12.0, -7.0, 1.5, 0.3, -0.2, 1.1;
  return se3_exp(xi);
}

struct DeviceOutcome : gpu::RegistrationState, gpu::RegistrationProgress {};

/// What the device leaves of an alignment that went well, with a made-up system.
DeviceOutcome good_state(const Matrix6d& h, const Vector6d& g, int inliers) {
  DeviceOutcome state{};
  state.pose = to_device(some_pose());
  state.converged = 1;
  state.iterations = 4;
  int k = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      state.system[k++] = static_cast<float>(h(i, j));
    }
  }
  for (int i = 0; i < 6; ++i) {
    state.system[k++] = static_cast<float>(g(i));
  }
  state.system[k++] = 40.0F;  // cost
  state.system[k++] = 4.0F;   // squared distances, m^2
  state.system[k++] = static_cast<float>(inliers);
  state.system[k++] = static_cast<float>(inliers);  // matches
  for (size_t i = 0; i < 6; ++i) {
    const float axis = i % 3 == 0 ? 1.0F : 0.0F;
    state.directions[i] = {axis, i % 3 == 1 ? 1.0F : 0.0F, i % 3 == 2 ? 1.0F : 0.0F, 5.0F};
    state.share[i] = 1.0F;
  }
  return state;
}

/// H and g of a sum of squares with random Jacobians, as a real alignment's are: positive definite.
struct Quadratic {
  Matrix6d h = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};

Quadratic some_quadratic() {
  std::srand(7);  // Eigen's Random
  Quadratic q;
  const Eigen::Matrix<double, 12, 6> j = Eigen::Matrix<double, 12, 6>::Random();
  q.h = j.transpose() * j;
  q.g = Vector6d::Random();
  return q;
}

RegistrationResult read(const DeviceOutcome& state, int source_points,
                        const RegistrationConfig& config = {}) {
  return read_registration({state, state}, source_points, 0.0, config);
}

// Magnusson 2009, equation 6.8, for 55 % outliers; worked out by hand for voxels of 1 m.
TEST(Registration, ScoreOfNdt) {
  const NdtScore score = ndt_score(1.0);
  EXPECT_NEAR(score.weight, 0.9603, 5e-4);
  EXPECT_NEAR(score.exponent, 0.21656, 5e-5);
  EXPECT_GT(ndt_score(2.0).exponent, 0.0);
}

TEST(Registration, APoseGoesToTheDeviceAndBackWithinFloatRounding) {
  const Eigen::Isometry3d back = from_device(to_device(some_pose()));
  EXPECT_LE((back.matrix() - some_pose().matrix()).norm(), 2e-6);
  EXPECT_LE((back.linear().transpose() * back.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-14)
      << "the host's poses are rotations to double precision";
}

TEST(Registration, TheSystemIsTurnedFromMapAxesIntoBodyAxes) {
  // The device perturbs about the source's origin in the target's axes: R <- Exp(w) R, t <- t + r.
  // The same motion in the body's axes is w = R phi, r = R rho, so a quadratic cost has one value
  // whichever way it is written.
  const Quadratic q = some_quadratic();
  const RegistrationResult result = read(good_state(q.h, q.g, 900), 1000);
  const Eigen::Matrix3d rotation = result.T_target_source.linear();
  for (int i = 0; i < 20; ++i) {
    const Vector6d body = Vector6d::Random();
    Vector6d target;
    target << rotation * body.head<3>(), rotation * body.tail<3>();
    EXPECT_NEAR(result.gradient.dot(body), q.g.dot(target), 1e-5);
    EXPECT_NEAR(body.dot(result.hessian * body), target.dot(q.h * target), 1e-4);

    const Eigen::Isometry3d in_body = retract(result.T_target_source, 0.1 * body);
    Eigen::Isometry3d in_target = result.T_target_source;
    in_target.linear() = so3_exp(0.1 * target.tail<3>()) * rotation;
    in_target.translation() += 0.1 * target.head<3>();
    EXPECT_LE((in_body.matrix() - in_target.matrix()).norm(), 1e-12);
  }
  EXPECT_EQ(result.hessian, result.hessian.transpose());
}

TEST(Registration, FiguresAreReadInTheirPlaces) {
  const Quadratic q = some_quadratic();
  const RegistrationResult result = read(good_state(q.h, q.g, 400), 1000);
  EXPECT_EQ(result.status, RegistrationStatus::converged);
  EXPECT_EQ(result.iterations, 4);
  EXPECT_EQ(result.inliers, 400);
  EXPECT_EQ(result.source_points, 1000);
  EXPECT_DOUBLE_EQ(result.overlap, 0.4);
  EXPECT_DOUBLE_EQ(result.cost, 40.0);
  EXPECT_DOUBLE_EQ(result.residual_rms, 0.1);  // sqrt(4 / 400)
}

TEST(Registration, EachWayToFailHasItsStatus) {
  const Quadratic q = some_quadratic();
  const RegistrationConfig config{.min_inliers = 100, .min_overlap = 0.3};
  const auto status = [&](auto&& change, int inliers = 900) {
    DeviceOutcome state = good_state(q.h, q.g, inliers);
    change(state);
    return read(state, 1000, config).status;
  };
  const auto nothing = [](DeviceOutcome&) {};
  EXPECT_EQ(status(nothing), RegistrationStatus::converged);
  EXPECT_EQ(status(nothing, 99), RegistrationStatus::too_few_points);
  EXPECT_EQ(status(nothing, 0), RegistrationStatus::too_few_points);
  EXPECT_EQ(status(nothing, 299), RegistrationStatus::too_little_overlap);
  EXPECT_EQ(status(nothing, 300), RegistrationStatus::converged);
  EXPECT_EQ(status([](auto& s) { s.converged = 0; }), RegistrationStatus::not_converged);
  EXPECT_EQ(status([](auto& s) { s.failed = 1; }), RegistrationStatus::diverged);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(status([&](auto& s) { s.pose.rows[1].w = nan; }), RegistrationStatus::diverged);
  EXPECT_EQ(status([&](auto& s) { s.system[0] = nan; }), RegistrationStatus::diverged);
  EXPECT_EQ(status([&](auto& s) { s.system[20] = HUGE_VALF; }), RegistrationStatus::diverged);
}

TEST(Registration, ASourceWithoutPointsIsTooFewWhateverTheDeviceLeft) {
  DeviceOutcome state = good_state(Matrix6d::Identity(), Vector6d::Zero(), 0);
  state.pose.rows[0].x = std::numeric_limits<float>::quiet_NaN();
  const RegistrationResult result = read(state, 0);
  EXPECT_EQ(result.status, RegistrationStatus::too_few_points);
  EXPECT_TRUE(result.T_target_source.matrix().allFinite());
  EXPECT_EQ(result.overlap, 0.0);
  EXPECT_EQ(result.residual_rms, 0.0);
}

TEST(Registration, EveryStatusHasAName) {
  using Status = RegistrationStatus;
  for (const Status status :
       {Status::converged, Status::degenerate, Status::not_converged, Status::too_little_overlap,
        Status::too_few_points, Status::diverged}) {
    EXPECT_NE(to_string(status), "unknown");
  }
}

}  // namespace
}  // namespace adit
