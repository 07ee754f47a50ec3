// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/coloring/camera_mounting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>

#include "adit/slam/core/median.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

constexpr std::array<int, 3> kBlurs = {8, 4, 1};  // pixels
constexpr int kMostRounds = 10;                   // of a blur
constexpr double kConverged = 0.1;                // of a step of the derivatives

using Views = std::pair<std::size_t, std::size_t>;

Views views_of(const std::vector<Sighted>& sighted, const SightedPair& pair) {
  return {sighted[pair.a].view, sighted[pair.b].view};
}

/// One half of the surfaces, by a bit of their keys, which are hashes.
bool tests(const Sighted& sighted) {
  return ((sighted.surface >> 40U) & 1U) == 1;
}

/// The differences within pairs, less the median of all pairs of the same views: what remains when
/// exposures are balanced.
std::vector<LogColor> residuals_of(const std::vector<Sighted>& sighted,
                                   const std::vector<SightedPair>& pairs) {
  std::map<Views, LogColor> medians;
  for (const ViewRatio& ratio : ratios_of(sighted, pairs)) {
    medians[{ratio.a, ratio.b}] = ratio.median;
  }
  std::vector<LogColor> residuals;
  residuals.reserve(pairs.size());
  for (const SightedPair& pair : pairs) {
    residuals.emplace_back(sighted[pair.b].color - sighted[pair.a].color -
                           medians.at(views_of(sighted, pair)));
  }
  return residuals;
}

/// The sighting of the same surface in the same view, where there is one.
std::optional<LogColor> color_in(const std::vector<Sighted>& all, const Sighted& one) {
  const auto key = [](const Sighted& sighted) { return std::pair(sighted.surface, sighted.view); };
  const auto found = std::ranges::lower_bound(all, key(one), {}, key);
  return found != all.end() && key(*found) == key(one) ? std::optional(found->color) : std::nullopt;
}

/// How a pair's difference changes with each part of the error; none where a step hides it.
std::optional<Eigen::Matrix<double, 3, 4>> slope(
    const std::vector<Sighted>& sighted, const SightedPair& pair,
    const std::array<std::array<std::vector<Sighted>, 2>, 4>& stepped, const CameraError& step) {
  Eigen::Matrix<double, 3, 4> jacobian;
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<LogColor, 2> differences;
    for (std::size_t side = 0; side < 2; ++side) {
      const auto a = color_in(stepped[k][side], sighted[pair.a]);
      const auto b = color_in(stepped[k][side], sighted[pair.b]);
      if (!a || !b) {
        return std::nullopt;
      }
      differences[side] = *b - *a;
    }
    const auto column = static_cast<Eigen::Index>(k);
    jacobian.col(column) = (differences[1] - differences[0]) / (2.0 * step[column]);
  }
  return jacobian;
}

/// The step of Gauss-Newton, its information as views disagree on it: what disturbs one surface of
/// a view, a shadow or a car, disturbs its neighbours, so views count and not surfaces (the
/// sandwich estimator of clusters, Liang and Zeger 1986). With the prior of the whole error. None
/// where too little says something.
std::optional<CameraError> weighed_step(const Eigen::Matrix4d& normal,
                                        const std::map<std::size_t, Eigen::Vector4d>& gradients,
                                        const CameraError& error) {
  constexpr std::size_t kLeastViews = 8;
  if (gradients.size() < kLeastViews) {
    return std::nullopt;
  }
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const auto& [view, gradient] : gradients) {
    sum += gradient;
  }
  const Eigen::Vector4d mean = sum / static_cast<double>(gradients.size());
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (const auto& [view, gradient] : gradients) {
    scatter += (gradient - mean) * (gradient - mean).transpose();
  }
  const Eigen::Vector4d prior = camera_error_prior().cwiseAbs2().cwiseInverse();
  // Without scatter nothing is known: images without texture.
  const Eigen::LDLT<Eigen::Matrix4d> scattered(scatter);
  if (!scattered.isPositive() || !(scattered.rcond() > 1e-12)) {
    return std::nullopt;
  }
  const Eigen::Matrix4d weight = normal * scattered.solve(Eigen::Matrix4d::Identity());
  Eigen::Matrix4d information = weight * normal;
  information.diagonal() += prior;
  return CameraError(information.ldlt().solve(weight * sum - prior.cwiseProduct(error)));
}

/// One step of Gauss-Newton with Cauchy's weights.
std::optional<CameraError> improved_step(const SightSurfaces& sight, const CameraError& error,
                                         const CameraError& hidden_by, const CameraError& step,
                                         int blur) {
  const std::vector<Sighted> sighted = sight(error, hidden_by, blur);
  std::array<std::array<std::vector<Sighted>, 2>, 4> stepped;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t side = 0; side < 2; ++side) {
      CameraError moved = error;
      const auto part = static_cast<Eigen::Index>(k);
      moved[part] += (side == 0 ? -1.0 : 1.0) * blur * step[part];
      stepped[k][side] = sight(moved, hidden_by, blur);
    }
  }
  std::vector<SightedPair> pairs = far_pairs(sighted);
  std::erase_if(pairs, [&](const SightedPair& pair) { return tests(sighted[pair.a]); });
  if (pairs.empty()) {
    return std::nullopt;
  }
  const std::vector<LogColor> residuals = residuals_of(sighted, pairs);
  std::vector<double> sizes;
  std::ranges::transform(residuals, std::back_inserter(sizes),
                         [](const LogColor& residual) { return residual.norm(); });
  constexpr double kSigmaOfMedian = 1.0 / 1.5382;  // of the length of a normal vector of three
  const double sigma = std::max(1e-3, kSigmaOfMedian * median(sizes));
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  std::map<std::size_t, Eigen::Vector4d> gradients;  // by the first view of the pairs
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (const auto jacobian = slope(sighted, pairs[i], stepped, blur * step)) {
      const double weight = 1.0 / (sigma * sigma + residuals[i].squaredNorm() / 3.0);
      normal += weight * jacobian->transpose() * *jacobian;
      gradients.try_emplace(sighted[pairs[i].a].view, Eigen::Vector4d::Zero()).first->second -=
          weight * jacobian->transpose() * residuals[i];
    }
  }
  return weighed_step(normal, gradients, error);
}

/// How far off the pairs of surfaces that test are.
std::map<std::pair<uint64_t, Views>, double> sizes_of_tests(const std::vector<Sighted>& sighted) {
  const std::vector<SightedPair> pairs = far_pairs(sighted);
  const std::vector<LogColor> residuals = residuals_of(sighted, pairs);
  std::map<std::pair<uint64_t, Views>, double> sizes;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Sighted& first = sighted[pairs[i].a];
    if (tests(first)) {
      sizes[{first.surface, views_of(sighted, pairs[i])}] = residuals[i].norm();
    }
  }
  return sizes;
}

}  // namespace

CameraError camera_error_prior() {
  return {kDegree, kDegree, kDegree, 0.02};
}

bool CameraErrorEstimate::is_better() const {
  const double sum = static_cast<double>(better + worse);
  return static_cast<double>(better) - static_cast<double>(worse) > 3.0 * std::sqrt(sum);
}

CameraErrorEstimate estimate_camera_error(const SightSurfaces& sight, const CameraError& step) {
  CameraErrorEstimate estimate;
  for (const int blur : kBlurs) {
    const CameraError hidden_by = estimate.error;
    for (int round = 0; round < kMostRounds; ++round) {
      const std::optional<CameraError> moved =
          improved_step(sight, estimate.error, hidden_by, step, blur);
      if (!moved) {
        return {};
      }
      estimate.error += *moved;
      if ((moved->array().abs() < kConverged * step.array()).all()) {
        break;
      }
    }
  }
  estimate.determined = true;
  const int sharpest = kBlurs.back();
  const auto before = sizes_of_tests(sight(CameraError::Zero(), CameraError::Zero(), sharpest));
  std::map<uint64_t, double> gains;  // by surface: how much smaller its differences become
  for (const auto& [looks, size] :
       sizes_of_tests(sight(estimate.error, estimate.error, sharpest))) {
    if (const auto found = before.find(looks); found != before.end()) {
      gains[looks.first] += found->second - size;
    }
  }
  for (const auto& [surface, gain] : gains) {
    ++(gain > 0.0 ? estimate.better : estimate.worse);
  }
  return estimate;
}

}  // namespace adit
