// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/horizontal_drift.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>

#include "adit/slam/core/median.hpp"
#include "adit/slam/graph/graph_information.hpp"
#include "adit/slam/graph/loop_optimization.hpp"

namespace adit {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Of scales, in half decades.
constexpr int kLeastStep = -4;
constexpr int kMostStep = 4;
// Of twice the logarithm of the likelihood's ratio, which is distributed as chi squared.
constexpr double kOneSigma = 1.0;
constexpr double kRuledOut = 3.84;
constexpr std::size_t kFewestPlaced = 3;  // nodes: two places have no shape
constexpr double kTellsNothing = 1e-3;    // by which it differs at the most
constexpr double kUsual = 9.0;            // times the usual variance

/// The world's vertical in the later node's axes, which an edge's information has.
Vector3d up_of(const PoseGraph& graph, const PoseEdge& edge) {
  const Eigen::Isometry3d& T_map_node = graph.nodes()[graph.index_of(edge.to)].T_map_node;
  return (graph.T_world_map().linear() * T_map_node.linear()).row(2).transpose();
}

/// What an edge knows at the least in the level: of the place (1/m^2) and of the heading (1/rad^2).
struct LevelKnowledge {
  double place = 0.0;
  double heading = 0.0;
};

LevelKnowledge level_knowledge(const PoseEdge& edge, const Vector3d& up) {
  const Matrix3d place = edge.information.topLeftCorner<3, 3>();
  const Matrix3d level = Matrix3d::Identity() - up * up.transpose();
  // The vertical's own direction is lifted beyond what the others have.
  const Matrix3d lifted = level * place * level + place.trace() * up * up.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(lifted, Eigen::EigenvaluesOnly);
  return {.place = eigen.eigenvalues()(0),
          .heading = up.dot(edge.information.bottomRightCorner<3, 3>() * up)};
}

double median_of(const std::vector<LevelKnowledge>& known, double LevelKnowledge::*which) {
  std::vector<double> values(known.size());
  std::ranges::transform(known, values.begin(), which);
  return median(std::move(values));
}

double step_scale(int step) {
  return std::pow(10.0, 0.5 * step);
}

/// Normal equations at a point: what the quadratic there falls by to its minimum, and the logarithm
/// of its determinant.
struct Quadratic {
  double fall = 0.0;
  double log_determinant = 0.0;
};

std::optional<Quadratic> quadratic(const GraphInformation& information) {
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(information.matrix());
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0.0)) {
    return std::nullopt;
  }
  const Eigen::VectorXd& gradient = information.gradient();
  return Quadratic{.fall = gradient.dot(solver.solve(gradient)),
                   .log_determinant = solver.vectorD().array().log().sum()};
}

PoseGraph without_loops(PoseGraph graph) {
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    if (graph.edges()[i].kind == EdgeKind::loop) {
      graph.set_status(i, EdgeStatus::revoked);
    }
  }
  return graph;
}

/// Of fixes and loops, given odometry and verticals: -2 log, less what is the same for all scales.
/// Both are Gaussian, so that the probability of the former is that of all of them over that of the
/// latter alone, each integrated over the poses.
std::optional<double> unlikeliness(const PoseGraph& weighted, double scale) {
  const PoseGraph scaled = with_horizontal_drift(weighted, scale);
  const PoseGraph chain = without_loops(scaled);
  GraphInformation all(scaled);
  all.add_edges();
  all.add_levels();
  all.add_fixes();
  all.add_headings();
  GraphInformation given(chain);
  given.add_edges();
  given.add_levels();
  const std::optional<Quadratic> of_all = quadratic(all);
  const std::optional<Quadratic> of_given = quadratic(given);
  if (!of_all || !of_given) {
    return std::nullopt;
  }
  return of_given->fall - of_all->fall + of_all->log_determinant - of_given->log_determinant;
}

}  // namespace

PoseGraph with_horizontal_drift(const PoseGraph& graph, double scale) {
  std::vector<LevelKnowledge> known;
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::odometry && edge.status == EdgeStatus::active) {
      known.push_back(level_knowledge(edge, up_of(graph, edge)));
    }
  }
  if (known.empty() || scale == 1.0) {
    return graph;
  }
  const double least_place = median_of(known, &LevelKnowledge::place) / kUsual;
  const double least_heading = median_of(known, &LevelKnowledge::heading) / kUsual;
  const double factor = 1.0 / std::sqrt(scale);
  return graph.with_information([&](const PoseEdge& edge) -> Matrix6d {
    const Vector3d up = up_of(graph, edge);
    const LevelKnowledge own = level_knowledge(edge, up);
    if (edge.kind != EdgeKind::odometry || own.place < least_place || own.heading < least_heading) {
      return edge.information;
    }
    const Matrix3d vertical = up * up.transpose();
    const Matrix3d level = Matrix3d::Identity() - vertical;
    Matrix6d scaling = Matrix6d::Zero();
    scaling.topLeftCorner<3, 3>() = vertical + factor * level;
    scaling.bottomRightCorner<3, 3>() = factor * vertical + level;
    const Matrix6d information = scaling * edge.information * scaling;
    return 0.5 * (information + information.transpose());
  });
}

HorizontalDrift horizontal_drift(const PoseGraph& graph) {
  std::set<NodeId> placed;
  std::ranges::transform(graph.fixes(), std::inserter(placed, placed.end()), &PositionFix::node);
  if (placed.size() < kFewestPlaced || graph.levels().empty()) {
    return {};
  }
  const PoseGraph weighted = as_weighted(graph);
  std::vector<double> found;
  for (int step = kLeastStep; step <= kMostStep; ++step) {
    const std::optional<double> value = unlikeliness(weighted, step_scale(step));
    if (!value || !std::isfinite(*value)) {
      return {};
    }
    found.push_back(*value);
  }
  const auto [least_at, most_at] = std::ranges::minmax_element(found);
  const double least = *least_at;
  if (*most_at - least < kTellsNothing) {
    return {};
  }
  const auto within = [&](double more) {
    return [=](double value) { return value <= least + more; };
  };
  const auto smallest = std::ranges::find_if(found, within(kOneSigma)) - found.begin();
  const auto above = std::find_if(found.rbegin(), found.rend(), within(kRuledOut)) - found.rbegin();
  return {.smallest = step_scale(kLeastStep + static_cast<int>(smallest)),
          .largest = step_scale(kMostStep - static_cast<int>(above))};
}

}  // namespace adit
