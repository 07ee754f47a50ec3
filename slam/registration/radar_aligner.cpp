// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/radar_aligner.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace adit {
namespace {

// Data sheets: ranges of 4D radars are good to 0.1 to 0.15 m, bearings to 1 to 2 degrees; those of
// a radar without elevations may be anywhere in its beam, 10 degrees up and down.
constexpr double kRangeSigma = 0.15;      // m
constexpr double kBearingSigma = 0.026;   // rad
constexpr double kFlatElevation = 0.175;  // rad
// The farthest returns are where the view ends. So does the map there, as if something ended: this
// share of the returns, the nearest, is matched.
constexpr double kMatched = 0.8;
// Scans that are aligned together, and that the map has.
constexpr std::size_t kTogether = 4;
constexpr std::size_t kMapped = 100;
// The map takes a scan once the sensor has moved so far since the last; the first it takes all.
constexpr double kNewPlace = 0.2;     // m
constexpr double kNewAttitude = 0.1;  // rad
constexpr std::size_t kFirst = 10;
// Voxels: the smallest, m; each next one has twice its edge. The noise must be several times
// smaller, or the Gaussian in one is as wide as itself.
constexpr double kSmallestVoxel = 1.0;
constexpr double kEdgeOfSigma = 5.0;
constexpr double kFewestInVoxel = 5.0;
// Variance of what is spread evenly over an edge of one: nothing is known within it.
constexpr double kUniform = 1.0 / 12.0;
constexpr int kMostSteps = 15;
constexpr double kConverged = 1e-4;  // m and rad
// Squared, standard deviations: Cauchy's kernel for ghosts.
constexpr double kGhost = 9.0;
// The information is given in units in which CovarianceModel's usual factor makes it what it is.
constexpr double kUsualInflation = 0.3;
constexpr double kUsualRms = 0.03;  // m
// Standard deviations by the matches alone: better ones hold a direction, worse ones do not. What
// checks the gyroscope by alignments takes rotations that are held for as good as a lidar's.
constexpr double kHeld = 0.05;       // m
constexpr double kUnheld = 0.5;      // m
constexpr double kHeldTurn = 0.001;  // rad
constexpr double kUnheldTurn = 0.005;

double square(double value) {
  return value * value;
}

double edge_of(std::size_t level) {
  return kSmallestVoxel * static_cast<double>(std::size_t{1} << level);
}

/// In a list of three, weakest first; `information`: the other three free.
std::array<ObservedDirection, 3> directions(const Matrix6d& information, int at, double held,
                                            double unheld) {
  const Eigen::Matrix3d own = information.block<3, 3>(at, at);
  const Eigen::Matrix3d mixed = information.block<3, 3>(at, 3 - at);
  const Eigen::Matrix3d other =
      information.block<3, 3>(3 - at, 3 - at) + 1e-9 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d free = own - mixed * other.ldlt().solve(mixed.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(0.5 * (free + free.transpose()));
  std::array<ObservedDirection, 3> result;
  for (int i = 0; i < 3; ++i) {
    ObservedDirection& one = result[static_cast<std::size_t>(i)];
    one.axis = eigen.eigenvectors().col(i);
    one.information = std::max(0.0, eigen.eigenvalues()[i]);
    one.support = one.information;
    one.localizability = one.information > 1.0 / (held * held)       ? Localizability::full
                         : one.information > 1.0 / (unheld * unheld) ? Localizability::partial
                                                                     : Localizability::none;
  }
  return result;
}

}  // namespace

bool is_radar_scan(const Sweep& sweep) {
  const auto is_return = [](const Point& point) {
    const Eigen::Vector3f p(point.x, point.y, point.z);
    return p.allFinite() && !p.isZero();
  };
  const auto measured =
      std::ranges::count_if(sweep.doppler, [](float u) { return std::isfinite(u); });
  const auto returns = static_cast<std::size_t>(std::ranges::count_if(sweep.points, is_return));
  return measured > 0 && returns > 0 && returns <= kMostRadarReturns;
}

Matrix6d radar_covariance(const RegistrationResult& alignment) {
  return kUsualInflation * symmetric_inverse(alignment.hessian);
}

/// Of matches, at a pose.
struct RadarAligner::Sums {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0.0;
  double squared_distance = 0.0;  ///< m²
  int matches = 0;
};

std::vector<RadarAligner::Return> RadarAligner::returns_of(const Sweep& scan) const {
  const bool flat = std::ranges::all_of(scan.points, [](const Point& p) { return p.z == 0.0F; });
  std::vector<Return> returns;
  for (const Point& point : scan.points) {
    const Eigen::Vector3d p(point.x, point.y, point.z);
    const double range = p.norm();
    if (!std::isfinite(range) || range < nearest_ || range > farthest_ || range <= 0.0) {
      continue;
    }
    const Eigen::Vector3d along = p / range;
    const double across = square(kBearingSigma * range);
    Return one{.p = p};
    one.covariance = across * Eigen::Matrix3d::Identity() +
                     (square(kRangeSigma) - across) * along * along.transpose();
    one.covariance(2, 2) += flat ? square(kFlatElevation * range) : 0.0;
    const double needed = kEdgeOfSigma * std::max(kRangeSigma, kBearingSigma * range);
    while (one.level + 1 < kLevels && edge_of(one.level) < needed) {
      ++one.level;
    }
    returns.push_back(one);
  }
  return returns;
}

std::vector<RadarAligner::Return> RadarAligner::nearest_of(std::vector<Return> returns) {
  std::vector<double> ranges;
  for (const Return& one : returns) {
    ranges.push_back(one.p.norm());
  }
  const auto kept = static_cast<std::size_t>(kMatched * static_cast<double>(ranges.size()));
  if (kept < ranges.size()) {
    const auto end = ranges.begin() + static_cast<std::ptrdiff_t>(kept);
    std::ranges::nth_element(ranges, end);
    std::erase_if(returns, [limit = *end](const Return& one) { return one.p.norm() >= limit; });
  }
  return returns;
}

void RadarAligner::clear() {
  recent_.clear();
  mapped_.clear();
  voxels_ = {};
}

void RadarAligner::add(const Sweep& scan, const Eigen::Isometry3d& T_map_lidar) {
  recent_.push_back({.returns = returns_of(scan), .T_map_lidar = T_map_lidar});
  if (recent_.size() < kTogether) {
    return;
  }
  Scan oldest = std::move(recent_.front());
  recent_.pop_front();
  if (mapped_.size() >= kFirst) {
    const Eigen::Isometry3d moved = mapped_.back().T_map_lidar.inverse() * oldest.T_map_lidar;
    if (moved.translation().norm() < kNewPlace && rotation_angle(moved.linear()) < kNewAttitude) {
      return;
    }
  }
  enter(oldest, 1.0);
  mapped_.push_back(std::move(oldest));
  if (mapped_.size() > kMapped) {
    enter(mapped_.front(), -1.0);
    mapped_.pop_front();
  }
}

void RadarAligner::enter(const Scan& scan, double sign) {
  const Eigen::Matrix3d& R = scan.T_map_lidar.linear();
  for (const Return& one : scan.returns) {
    const Eigen::Vector3d p = scan.T_map_lidar * one.p;
    for (std::size_t level = 0; level < kLevels; ++level) {
      const double edge = edge_of(level);
      const Eigen::Vector3d corner = (p / edge).array().floor();
      const Key key = {static_cast<int64_t>(corner.x()), static_cast<int64_t>(corner.y()),
                       static_cast<int64_t>(corner.z())};
      Voxel& voxel = voxels_[level][key];
      const Eigen::Vector3d within = p - edge * corner;
      voxel.count += sign;
      voxel.sum += sign * within;
      voxel.squares += sign * within * within.transpose();
      voxel.noise += sign * R * one.covariance * R.transpose();
      if (voxel.count < 0.5) {
        voxels_[level].erase(key);
      }
    }
  }
}

std::optional<RadarAligner::Gaussian> RadarAligner::gaussian_at(std::size_t level,
                                                                const Eigen::Vector3d& p) const {
  const double edge = edge_of(level);
  const Eigen::Vector3d corner = (p / edge).array().floor();
  const auto found =
      voxels_[level].find({static_cast<int64_t>(corner.x()), static_cast<int64_t>(corner.y()),
                           static_cast<int64_t>(corner.z())});
  if (found == voxels_[level].end() || found->second.count < kFewestInVoxel) {
    return std::nullopt;
  }
  const Voxel& voxel = found->second;
  const Eigen::Vector3d mean = voxel.sum / voxel.count;
  // Few returns say less of the spread than the sensor's noise does; it may be larger than they
  // show by two standard deviations of a variance.
  const Eigen::Matrix3d spread =
      (voxel.squares - voxel.count * mean * mean.transpose() + voxel.noise / voxel.count) /
      (voxel.count - 1.0);
  const double larger = 1.0 + 2.0 * std::sqrt(2.0 / (voxel.count - 1.0));
  return Gaussian{&voxel, edge * corner + mean, larger * spread};
}

RadarAligner::Sums RadarAligner::matches_at(const std::vector<Return>& returns,
                                            const Eigen::Isometry3d& T_map_lidar) const {
  const Eigen::Matrix3d& R = T_map_lidar.linear();
  Sums sums;
  std::vector<std::optional<Gaussian>> gaussians;
  std::map<const Voxel*, double> counts;  // by address: nothing goes through it in order
  for (const Return& one : returns) {
    gaussians.push_back(gaussian_at(one.level, T_map_lidar * one.p));
    counts[gaussians.back() ? gaussians.back()->voxel : nullptr] += 1.0;
  }
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const Return& one = returns[i];
    const std::optional<Gaussian>& gaussian = gaussians[i];
    if (!gaussian) {
      continue;
    }
    const Eigen::Vector3d p = T_map_lidar * one.p;
    const Eigen::Matrix3d covariance = gaussian->covariance + R * one.covariance * R.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
    // What an even spread over the voxel has is no information: a wall holds nothing along itself.
    const double edge = edge_of(one.level);
    const Eigen::Vector3d weights =
        (eigen.eigenvalues().cwiseMax(1e-6).cwiseInverse().array() - 1.0 / (kUniform * edge * edge))
            .max(0.0);
    const Eigen::Matrix3d omega =
        eigen.eigenvectors() * weights.asDiagonal() * eigen.eigenvectors().transpose();
    const Eigen::Vector3d error = p - gaussian->mean;
    const double squared = error.dot(omega * error);
    // All returns in a voxel share the error of its mean, of as many as it was made of.
    const double shared =
        gaussian->voxel->count / (gaussian->voxel->count + counts.at(gaussian->voxel));
    const double weight = shared / (1.0 + squared / kGhost);
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << R, -R * skew(one.p);
    sums.information += weight * jacobian.transpose() * omega * jacobian;
    sums.gradient += weight * jacobian.transpose() * omega * error;
    sums.cost += squared;
    ++sums.matches;
  }
  // Returns count in each alignment that they are in, but are one measurement.
  const double share = kUsualInflation / static_cast<double>(kTogether);
  sums.information *= share;
  sums.gradient *= share;
  return sums;
}

RegistrationResult RadarAligner::align(const Sweep& scan, const Prediction& prediction,
                                       bool known) const {
  std::vector<Return> returns = returns_of(scan);
  const std::size_t own = returns.size();
  const Eigen::Isometry3d T_lidar_map = prediction.T_map_lidar.inverse();
  for (const Scan& before : known ? recent_ : std::deque<Scan>()) {
    const Eigen::Isometry3d T_lidar_before = T_lidar_map * before.T_map_lidar;
    const Eigen::Matrix3d& R = T_lidar_before.linear();
    for (Return one : before.returns) {
      one.p = T_lidar_before * one.p;
      one.covariance = R * one.covariance * R.transpose();
      returns.push_back(one);
    }
  }
  returns = nearest_of(std::move(returns));
  const Matrix6d prior = prediction.information.value_or(
      Matrix6d(kUsualInflation * prediction.sigma.cwiseAbs2().cwiseInverse().asDiagonal()));
  RegistrationResult result;
  result.T_target_source = prediction.T_map_lidar;
  result.used_prior = true;
  result.source_points = static_cast<int>(returns.size());
  Sums sums;
  for (int step = 0; step < kMostSteps; ++step) {
    sums = matches_at(returns, result.T_target_source);
    result.iterations = step + 1;
    const Eigen::Isometry3d off = prediction.T_map_lidar.inverse() * result.T_target_source;
    Vector6d from_prior;  // as retract() has it
    from_prior << result.T_target_source.linear().transpose() * prediction.T_map_lidar.linear() *
                      off.translation(),
        so3_log(off.linear());
    result.hessian = sums.information + prior;
    result.gradient = sums.gradient + prior * from_prior;
    const Vector6d change = -result.hessian.ldlt().solve(result.gradient);
    if (!change.allFinite()) {
      result.status = RegistrationStatus::diverged;
      return result;
    }
    if (change.norm() < kConverged) {
      break;
    }
    result.T_target_source = retract(result.T_target_source, change);
  }
  result.information = sums.information;
  result.pull = sums.gradient;
  result.cost = sums.cost;
  result.residual_rms = kUsualRms;
  result.overlap = 1.0;
  result.inliers = sums.matches;
  result.matches = sums.matches;
  const Matrix6d own_units = sums.information / kUsualInflation;
  result.translation = directions(own_units, 0, kHeld, kUnheld);
  result.rotation = directions(own_units, 3, kHeldTurn, kUnheldTurn);
  const bool holds_all = result.translation[0].localizability != Localizability::none;
  result.status = own < static_cast<std::size_t>(kFewestRadarReturns) && !known
                      ? RegistrationStatus::too_few_points
                  : !known && !holds_all ? RegistrationStatus::too_little_overlap
                  : holds_all            ? RegistrationStatus::converged
                                         : RegistrationStatus::degenerate;
  return result;
}

}  // namespace adit
