// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/coloring/view_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include <Eigen/SparseCholesky>

#include "adit/slam/core/median.hpp"

namespace adit {
namespace {

constexpr uint8_t kDarkest = 5;  // of 8 bits: below, rounding is a tenth of the value
// Of a surface's logarithm between two views: gloss, an edge between two pixels. Its square over
// the number of surfaces is a median's variance; no fewer than 1/16 of it, since what disturbs one
// disturbs its neighbours.
constexpr double kSurfaceSigma = 0.2;
constexpr std::size_t kMostIndependent = 256;
constexpr double kPriorSigma = std::numbers::ln2;

double weight_of(const ViewRatio& ratio) {
  return static_cast<double>(std::min(ratio.surfaces, kMostIndependent)) /
         (kSurfaceSigma * kSurfaceSigma);
}

/// How much of the gains is more than what noise gives: 1 - 1/F, where F compares what each gain
/// explains with what is left to each further pair (James and Stein 1961). Exposures that do not
/// vary are left alone. Where there are no further pairs nothing tells, and gains stay.
double explained(const Eigen::MatrixX3d& logs, std::span<const ViewRatio> ratios) {
  double before = 0.0;
  double after = 0.0;
  std::set<std::size_t> compared;
  for (const ViewRatio& ratio : ratios) {
    const LogColor gain = (logs.row(static_cast<Eigen::Index>(ratio.a)) -
                           logs.row(static_cast<Eigen::Index>(ratio.b)))
                              .transpose();
    compared.insert({ratio.a, ratio.b});
    before += weight_of(ratio) * ratio.median.squaredNorm();
    after += weight_of(ratio) * (ratio.median - gain).squaredNorm();
  }
  const double pairs = static_cast<double>(ratios.size());
  const double views = static_cast<double>(compared.size());
  if (pairs <= views) {
    return 1.0;
  }
  const double F = (before - after) / views / std::max(1e-12, after / (pairs - views));
  return std::max(0.0, 1.0 - 1.0 / std::max(F, 1e-12));
}

}  // namespace

bool is_exposed(const SeenColor& seen) {
  return seen.sightings > 0 && std::ranges::all_of(seen.color, [](uint8_t value) {
           return value >= kDarkest && value <= gpu::kBrightest;
         });
}

LogColor log_color(const SeenColor& seen) {
  return {std::log(static_cast<double>(seen.color[0])),
          std::log(static_cast<double>(seen.color[1])),
          std::log(static_cast<double>(seen.color[2]))};
}

void sort_by_surface(std::vector<Sighted>& sighted) {
  std::ranges::sort(sighted, {},
                    [](const Sighted& one) { return std::pair(one.surface, one.view); });
}

std::vector<SightedPair> far_pairs(const std::vector<Sighted>& sighted) {
  std::vector<SightedPair> pairs;
  for (std::size_t begin = 0; begin < sighted.size();) {
    std::size_t end = begin + 1;
    while (end < sighted.size() && sighted[end].surface == sighted[begin].surface) {
      ++end;
    }
    const std::size_t apart = std::max<std::size_t>(1, (end - begin) / 2);
    for (std::size_t i = begin; i + apart < end; ++i) {
      pairs.push_back({.a = i, .b = i + apart});
    }
    begin = end;
  }
  return pairs;
}

std::vector<ViewRatio> ratios_of(const std::vector<Sighted>& sighted,
                                 const std::vector<SightedPair>& pairs) {
  std::map<std::pair<std::size_t, std::size_t>, std::array<std::vector<double>, 3>> logs;
  for (const SightedPair& pair : pairs) {
    const Sighted& a = sighted[pair.a];
    const Sighted& b = sighted[pair.b];
    auto& of_views = logs[{a.view, b.view}];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto channel = static_cast<Eigen::Index>(k);
      of_views[k].push_back(b.color[channel] - a.color[channel]);
    }
  }
  std::vector<ViewRatio> ratios;
  for (const auto& [views, of_views] : logs) {
    ratios.push_back({.a = views.first,
                      .b = views.second,
                      .median = {median(of_views[0]), median(of_views[1]), median(of_views[2])},
                      .surfaces = of_views[0].size()});
  }
  return ratios;
}

std::vector<std::array<float, 3>> balanced_gains(std::size_t views,
                                                 std::span<const ViewRatio> ratios) {
  std::vector<std::array<float, 3>> gains(views, {1.0F, 1.0F, 1.0F});
  if (ratios.empty()) {
    return gains;
  }
  const auto size = static_cast<Eigen::Index>(views);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(size, 3);
  for (Eigen::Index i = 0; i < size; ++i) {
    entries.emplace_back(i, i, 1.0 / (kPriorSigma * kPriorSigma));
  }
  for (const ViewRatio& ratio : ratios) {
    const double weight = weight_of(ratio);
    const auto a = static_cast<Eigen::Index>(ratio.a);
    const auto b = static_cast<Eigen::Index>(ratio.b);
    entries.emplace_back(a, a, weight);
    entries.emplace_back(b, b, weight);
    entries.emplace_back(a, b, -weight);
    entries.emplace_back(b, a, -weight);
    right.row(a) += weight * ratio.median.transpose();
    right.row(b) -= weight * ratio.median.transpose();
  }
  Eigen::SparseMatrix<double> normal(size, size);
  normal.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  const Eigen::MatrixX3d fitted = solver.solve(right);
  const Eigen::MatrixX3d logs = explained(fitted, ratios) * fitted;
  for (std::size_t i = 0; i < views; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      gains[i][k] = static_cast<float>(
          std::exp(logs(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k))));
    }
  }
  return gains;
}

}  // namespace adit
