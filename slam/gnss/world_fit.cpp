// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/world_fit.hpp"

#include <algorithm>
#include <cmath>

#include "adit/slam/gnss/gnss_noise.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kHypotheses = 400;
constexpr int kRefinements = 5;
constexpr double kPairGate = 9.21;  // chi squared of two directions, 99 %
constexpr double kMapDrift = 0.01;  // of the distance from the middle of the pairs
constexpr std::size_t kFewestPairs = 3;

Vector2d level(const Eigen::Vector3d& p) {
  return p.head<2>();
}

/// The larger of the two horizontal standard deviations, squared.
double variance_of(const PositionPair& pair) {
  return std::max(pair.covariance(0, 0), pair.covariance(1, 1));
}

/// p_world = turn(yaw) p_map + t, horizontally; z apart.
struct Placement {
  double yaw = 0.0;
  Vector2d t = Vector2d::Zero();

  Vector2d operator*(const Vector2d& p) const { return Eigen::Rotation2Dd(yaw) * p + t; }
};

class Fitter {
 public:
  explicit Fitter(std::span<const PositionPair> pairs) : pairs_(pairs) {
    for (const PositionPair& pair : pairs_) {
      middle_ += level(pair.p_map) / static_cast<double>(pairs_.size());
    }
  }

  bool agrees(const PositionPair& pair, const Placement& placement) const {
    const double drift = kMapDrift * (level(pair.p_map) - middle_).norm();
    const double variance = variance_of(pair) + drift * drift + kMapNoise * kMapNoise;
    return (placement * level(pair.p_map) - level(pair.p_world)).squaredNorm() <
           kPairGate * variance;
  }

  std::vector<bool> agreeing(const Placement& placement) const {
    std::vector<bool> result;
    for (const PositionPair& pair : pairs_) {
      result.push_back(agrees(pair, placement));
    }
    return result;
  }

  /// The one that most agree with among those that two pairs make, spread evenly over all.
  std::optional<Placement> consensus() const {
    std::optional<Placement> best;
    std::ptrdiff_t most = 0;
    const std::size_t count = pairs_.size();
    for (std::size_t k = 0; k < kHypotheses; ++k) {
      const std::size_t i = k * 7919 % count;
      const std::size_t apart = 1 + k * 104729 % (count - 1);
      const auto placement = of_two(pairs_[i], pairs_[(i + apart) % count]);
      if (!placement) {
        continue;
      }
      const std::vector<bool> agreed = agreeing(*placement);
      const auto votes = std::ranges::count(agreed, true);
      if (votes > most) {
        most = votes;
        best = placement;
      }
    }
    return best;
  }

  /// Weighted least squares over those that agree: yaw = atan2(sum w x cross y, sum w x dot y).
  std::optional<Placement> least_squares(const std::vector<bool>& agreed) const {
    double weights = 0.0;
    Vector2d map = Vector2d::Zero();
    Vector2d world = Vector2d::Zero();
    each(agreed, [&](const PositionPair& pair, double weight) {
      weights += weight;
      map += weight * level(pair.p_map);
      world += weight * level(pair.p_world);
    });
    map /= weights;
    world /= weights;
    double cross = 0.0;
    double dot = 0.0;
    each(agreed, [&](const PositionPair& pair, double weight) {
      const Vector2d x = level(pair.p_map) - map;
      const Vector2d y = level(pair.p_world) - world;
      cross += weight * (x.x() * y.y() - x.y() * y.x());
      dot += weight * x.dot(y);
    });
    if (!(std::hypot(cross, dot) > 0.0)) {
      return std::nullopt;
    }
    Placement placement{.yaw = std::atan2(cross, dot)};
    placement.t = world - Eigen::Rotation2Dd(placement.yaw) * map;
    return placement;
  }

  double height(const std::vector<bool>& agreed) const {
    double sum = 0.0;
    double weights = 0.0;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const double weight = agreed[i] ? 1.0 / pairs_[i].covariance(2, 2) : 0.0;
      weights += weight;
      sum += weight * (pairs_[i].p_world.z() - pairs_[i].p_map.z());
    }
    return sum / weights;
  }

  /// sigma = 1 / sqrt(sum of w |x|^2), each pair with its share of independence.
  double yaw_sigma(const std::vector<bool>& agreed, double correlation) const {
    std::vector<double> times;
    Vector2d middle = Vector2d::Zero();
    double weights = 0.0;
    each(agreed, [&](const PositionPair& pair, double weight) {
      times.push_back(pair.time);
      middle += weight * level(pair.p_map);
      weights += weight;
    });
    middle /= weights;
    const std::vector<double> shares = independent_shares(times, correlation);
    double information = 0.0;
    std::size_t at = 0;
    each(agreed, [&](const PositionPair& pair, double weight) {
      information += shares[at++] * weight * (level(pair.p_map) - middle).squaredNorm();
    });
    return 1.0 / std::sqrt(information);
  }

 private:
  template <class Use>
  void each(const std::vector<bool>& agreed, const Use& use) const {
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (agreed[i]) {
        use(pairs_[i], 1.0 / variance_of(pairs_[i]));
      }
    }
  }

  /// None where they are too near to each other to tell a direction.
  static std::optional<Placement> of_two(const PositionPair& a, const PositionPair& b) {
    const Vector2d map = level(b.p_map) - level(a.p_map);
    const Vector2d world = level(b.p_world) - level(a.p_world);
    const double sigma = std::sqrt(variance_of(a) + variance_of(b));
    if (map.norm() < 2.0 * sigma ||
        std::abs(map.norm() - world.norm()) > 3.0 * sigma + kMapNoise + kMapDrift * map.norm()) {
      return std::nullopt;
    }
    Placement placement{.yaw = std::atan2(world.y(), world.x()) - std::atan2(map.y(), map.x())};
    const Vector2d middle = 0.5 * (level(a.p_map) + level(b.p_map));
    placement.t =
        0.5 * (level(a.p_world) + level(b.p_world)) - Eigen::Rotation2Dd(placement.yaw) * middle;
    return placement;
  }

  std::span<const PositionPair> pairs_;
  Vector2d middle_ = Vector2d::Zero();
};

}  // namespace

std::optional<WorldFit> fit_world(std::span<const PositionPair> pairs, double correlation) {
  if (pairs.size() < kFewestPairs) {
    return std::nullopt;
  }
  const Fitter fitter(pairs);
  std::optional<Placement> placement = fitter.consensus();
  if (!placement) {
    return std::nullopt;
  }
  WorldFit fit{.agrees = fitter.agreeing(*placement)};
  for (int round = 0; round < kRefinements; ++round) {
    fit.agreeing = static_cast<std::size_t>(std::ranges::count(fit.agrees, true));
    const auto better =
        fit.agreeing < kFewestPairs ? std::nullopt : fitter.least_squares(fit.agrees);
    if (!better) {
      return std::nullopt;
    }
    placement = better;
    fit.agrees = fitter.agreeing(*placement);
  }
  fit.agreeing = static_cast<std::size_t>(std::ranges::count(fit.agrees, true));
  if (fit.agreeing < kFewestPairs) {
    return std::nullopt;
  }
  fit.T_world_map.linear() =
      Eigen::AngleAxisd(placement->yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  fit.T_world_map.translation() << placement->t, fitter.height(fit.agrees);
  fit.yaw_sigma = fitter.yaw_sigma(fit.agrees, correlation);
  return fit;
}

}  // namespace adit
