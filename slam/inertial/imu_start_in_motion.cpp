// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "adit/slam/inertial/imu_start.hpp"
#include "adit/slam/inertial/preintegration.hpp"

namespace adit {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr size_t kFewestPoses = 6;
constexpr double kShortest = 0.5;              // s between the first and the last pose
constexpr double kPositionSigma = 0.02;        // m, of each pose
constexpr double kRotationSigma = 0.005;       // rad, of each pose
constexpr double kAccelBiasSigma = 0.1;        // m/s², before anything is seen of it
constexpr double kGravityTolerance = 1.0;      // m/s², of its free length
constexpr double kLeastScale = 0.7;            // share of gravity: less is no error of scale
constexpr double kLargestGravitySigma = 0.05;  // rad
constexpr double kUnheldSigma = 3.0;           // m, of a position along what nothing held

/// Poses with what was integrated between them.
struct Links {
  std::span<const StampedPose> poses;
  std::span<const std::vector<Eigen::Vector3d>> unheld;
  std::vector<Preintegration> between;

  std::span<const Eigen::Vector3d> unheld_of(size_t pose) const {
    return unheld.empty() ? std::span<const Eigen::Vector3d>() : unheld[pose];
  }
};

std::vector<Preintegration> integrated(std::span<const std::vector<ImuSample>> readings,
                                       double accel_scale, const Eigen::Vector3d& gyro_bias,
                                       const ImuNoise& noise) {
  std::vector<Preintegration> result;
  for (const std::vector<ImuSample>& samples : readings) {
    result.push_back(preintegrate(with_accel_scale(samples, accel_scale),
                                  {.gyro = gyro_bias, .accel = {0, 0, 0}}, noise));
  }
  return result;
}

struct GyroBias {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

/// Rotations are linear enough in the bias that three Gauss-Newton steps end at the optimum.
GyroBias gyro_bias_of(std::span<const StampedPose> poses,
                      std::span<const std::vector<ImuSample>> readings, const ImuNoise& noise) {
  GyroBias bias;
  for (int iteration = 0; iteration < 3; ++iteration) {
    const std::vector<Preintegration> between = integrated(readings, 1.0, bias.value, noise);
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < between.size(); ++i) {
      const Eigen::Matrix3d turned =
          poses[i].pose.linear().transpose() * poses[i + 1].pose.linear();
      const Eigen::Vector3d error = so3_log(between[i].increment.rotation.transpose() * turned);
      const Eigen::Matrix3d& jacobian = between[i].rotation_by_gyro;
      h += jacobian.transpose() * jacobian;
      g += jacobian.transpose() * error;
    }
    bias.value += h.ldlt().solve(g);
    bias.sigma = std::sqrt(2.0) * kRotationSigma * h.inverse().diagonal().cwiseSqrt();
  }
  return bias;
}

/// A least-squares problem, row by row: A x = b with the rows already weighted.
class LeastSquares {
 public:
  explicit LeastSquares(Eigen::Index unknowns)
      : h_(Matrix::Zero(unknowns, unknowns)), g_(Vector::Zero(unknowns)) {}

  void add(const Matrix& a, const Vector& b, double sigma) {
    const double weight = 1.0 / (sigma * sigma);
    h_ += weight * a.transpose() * a;
    g_ += weight * a.transpose() * b;
    constant_ += weight * b.squaredNorm();
    rows_ += static_cast<int>(b.size());
  }
  Vector solution() const { return h_.ldlt().solve(g_); }
  Matrix covariance() const { return h_.ldlt().solve(Matrix::Identity(h_.rows(), h_.cols())); }
  /// Mean square of the weighted residuals at `x`, a row.
  double mean_square(const Vector& x) const {
    return (constant_ - 2.0 * g_.dot(x) + x.dot(h_ * x)) / rows_;
  }

 private:
  Matrix h_;
  Vector g_;
  double constant_ = 0.0;
  int rows_ = 0;
};

struct Solution {
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< at the last pose
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();
  Matrix covariance;  ///< ordered [gravity parameters, velocity, accelerometer bias]
  double mean_square = 0.0;
};

/// A unit and a sign of the accelerometer, and what they make of the motion.
struct Explanation {
  double accel_scale = 1.0;
  Solution solution;
};

/// Velocities at all poses, gravity = origin + basis * parameters, accelerometer bias, and by how
/// much poses are off along what nothing held.
Solution solve(const Links& links, const Eigen::Vector3d& origin, const Matrix& basis) {
  const auto n = static_cast<Eigen::Index>(links.poses.size());
  const Eigen::Index gravity_at = 3 * n;
  const Eigen::Index bias_at = gravity_at + basis.cols();
  std::vector<Eigen::Index> off_at;  // of each pose, and where they end
  Eigen::Index size = bias_at + 3;
  for (size_t i = 0; i < links.poses.size(); ++i) {
    off_at.push_back(size);
    size += static_cast<Eigen::Index>(links.unheld_of(i).size());
  }
  const auto move = [&](Matrix& a, size_t pose, double sign) {
    for (size_t k = 0; k < links.unheld_of(pose).size(); ++k) {
      a.col(off_at[pose] + static_cast<Eigen::Index>(k)) += sign * links.unheld_of(pose)[k];
    }
  };
  LeastSquares system(size);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const Preintegration& link = links.between[static_cast<size_t>(i)];
    const Eigen::Isometry3d& pose = links.poses[static_cast<size_t>(i)].pose;
    const Eigen::Matrix3d& R = pose.linear();
    const Eigen::Vector3d moved =
        links.poses[static_cast<size_t>(i) + 1].pose.translation() - pose.translation();
    const double t = link.duration;
    Matrix a = Matrix::Zero(3, size);
    a.block<3, 3>(0, 3 * i) = t * Eigen::Matrix3d::Identity();
    a.middleCols(gravity_at, basis.cols()) = 0.5 * t * t * basis;
    a.middleCols<3>(bias_at) = R * link.position_by_accel;
    move(a, static_cast<size_t>(i), 1.0);
    move(a, static_cast<size_t>(i) + 1, -1.0);
    system.add(a, moved - R * link.increment.position - 0.5 * t * t * origin,
               std::sqrt(2.0) * kPositionSigma);
    a.setZero();
    a.block<3, 3>(0, 3 * i) = -Eigen::Matrix3d::Identity();
    a.block<3, 3>(0, 3 * (i + 1)) = Eigen::Matrix3d::Identity();
    a.middleCols(gravity_at, basis.cols()) = -t * basis;
    a.middleCols<3>(bias_at) = -R * link.velocity_by_accel;
    const double sigma = std::sqrt(link.covariance(kVelocityAt, kVelocityAt)) +
                         kRotationSigma * kStandardGravity * t;
    system.add(a, R * link.increment.velocity + t * origin, sigma);
  }
  Matrix prior = Matrix::Zero(3, size);
  prior.middleCols<3>(bias_at).setIdentity();
  system.add(prior, Vector::Zero(3), kAccelBiasSigma);
  for (Eigen::Index k = bias_at + 3; k < size; ++k) {
    system.add(Vector::Unit(size, k).transpose(), Vector::Zero(1), kUnheldSigma);
  }

  const Vector x = system.solution();
  const Eigen::Index kept = basis.cols() + 6;
  return {.gravity = origin + basis * x.segment(gravity_at, basis.cols()),
          .velocity = x.segment<3>(gravity_at - 3),
          .accel_bias = x.segment<3>(bias_at),
          .covariance = system.covariance().block(gravity_at - 3, gravity_at - 3, kept, kept),
          .mean_square = system.mean_square(x)};
}

/// Two directions across `v`, as columns.
Matrix across(const Eigen::Vector3d& v) {
  return level_attitude(v).topRows<2>().transpose();
}

/// With gravity's length known: its direction alone is solved for.
Solution solve_direction(const Links& links, const Eigen::Vector3d& first_guess) {
  Solution solution;
  solution.gravity = first_guess;
  for (int iteration = 0; iteration < 4; ++iteration) {
    const Eigen::Vector3d gravity = kStandardGravity * solution.gravity.normalized();
    solution = solve(links, gravity, kStandardGravity * across(gravity));
  }
  solution.gravity = kStandardGravity * solution.gravity.normalized();
  return solution;
}

ImuStart refused(ImuStartStatus status, const ImuStartReason& reason) {
  ImuStart start;
  start.status = status;
  start.reason = reason;
  return start;
}

}  // namespace

ImuStart start_in_motion(std::span<const StampedPose> T_map_body,
                         std::span<const std::vector<ImuSample>> readings, const ImuNoise& noise,
                         std::span<const std::vector<Eigen::Vector3d>> unheld) {
  if (T_map_body.size() < kFewestPoses || readings.size() + 1 != T_map_body.size() ||
      seconds(T_map_body.back().stamp - T_map_body.front().stamp) < kShortest) {
    return refused(ImuStartStatus::too_short,
                   TooFewPoses{.poses = T_map_body.size(), .needed = kFewestPoses});
  }
  const GyroBias gyro = gyro_bias_of(T_map_body, readings, noise);
  const Matrix free = Matrix::Identity(3, 3);
  const bool any_unheld = !std::ranges::all_of(unheld, [](const auto& one) { return one.empty(); });
  // Of each sign, the unit that makes a gravity like the Earth's.
  std::optional<Explanation> usual;
  std::optional<Explanation> opposite;
  double free_norm = 0.0;
  double refused_norm = 0.0;  // with the usual sign, in m/s²
  for (const double hypothesis : {1.0, kStandardGravity, -1.0, -kStandardGravity}) {
    const Links links{T_map_body, unheld, integrated(readings, hypothesis, gyro.value, noise)};
    const Solution unknown_length = solve(links, Eigen::Vector3d::Zero(), free);
    const double unclear = std::sqrt(unknown_length.covariance.diagonal().segment<3>(3).maxCoeff());
    if (any_unheld && unclear > kGravityTolerance) {
      return refused(ImuStartStatus::unobserved,
                     GravityUnclear{.sigma = unclear / kStandardGravity});
    }
    const double norm = unknown_length.gravity.norm();
    free_norm = hypothesis == 1.0 ? norm : free_norm;
    // The length says nothing of the sign: where it is off by some scale, so it is for both.
    const bool scaled = hypothesis < 0.0 && refused_norm > kLeastScale * kStandardGravity &&
                        kLeastScale * refused_norm < kStandardGravity;
    if (std::abs(norm - kStandardGravity) > kGravityTolerance || scaled) {
      refused_norm = hypothesis > 0.0 && refused_norm == 0.0 ? norm : refused_norm;
      continue;
    }
    std::optional<Explanation>& found = hypothesis > 0.0 ? usual : opposite;
    if (!found) {
      found = Explanation{hypothesis, solve_direction(links, unknown_length.gravity)};
    }
  }
  if (!usual && !opposite) {
    return refused(ImuStartStatus::implausible, NoGravityInMotion{.gravity = free_norm});
  }
  const bool negative = !usual || (opposite && usual->solution.mean_square >=
                                                   kClearlyBetter * opposite->solution.mean_square);
  const Solution& best = negative ? opposite->solution : usual->solution;
  const std::optional<Explanation>& other = negative ? usual : opposite;
  const double sigma = std::sqrt(best.covariance.diagonal().segment<2>(3).maxCoeff());
  if (sigma > kLargestGravitySigma) {
    return refused(ImuStartStatus::unobserved, GravityUnclear{.sigma = sigma});
  }
  ImuStart start;
  start.status = ImuStartStatus::in_motion;
  start.accel_scale = negative ? opposite->accel_scale : usual->accel_scale;
  if (other) {
    start.other_sign_error = other->solution.mean_square / best.mean_square;
  }
  start.reason = StartedInMotion{.poses = T_map_body.size(),
                                 .in_g = std::abs(start.accel_scale) != 1.0,
                                 .negative = negative,
                                 .usual_error = negative && other ? start.other_sign_error : 0.0};
  start.gravity_map = best.gravity;
  start.up_body = T_map_body.back().pose.linear().transpose() * -best.gravity.normalized();
  start.gravity_sigma = sigma;
  start.v_map_body = best.velocity;
  start.velocity_sigma = std::sqrt(best.covariance.diagonal().head<3>().maxCoeff());
  start.bias = {.gyro = gyro.value, .accel = best.accel_bias};
  start.bias_sigma.gyro = gyro.sigma;
  start.bias_sigma.accel = best.covariance.diagonal().tail<3>().cwiseSqrt();
  return start;
}

}  // namespace adit
