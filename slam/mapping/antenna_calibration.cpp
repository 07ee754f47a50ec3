// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/antenna_calibration.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>

#include "adit/slam/mapping/graph_information.hpp"

namespace adit {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::size_t kFewestSightings = 10;
constexpr double kSightingGate = 11.34;  // chi squared of three directions, 99 %
constexpr double kScaleStep = 4.0;       // of the kernel's squared width, from round to round
constexpr int kRoundsAtTheGate = 3;
constexpr std::size_t kBlocks = 5;    // of the jackknife
constexpr double kSignificant = 4.0;  // standard deviations
// What is known no better is of no use, and what is smaller makes no difference to a map: of the
// lever arm (m) and of the delay (s).
constexpr double kUsefulLever = 0.1;
constexpr double kUsefulDelay = 0.05;
constexpr double kLeastLever = 0.05;
constexpr double kLeastDelay = 0.01;

class AntennaProblem {
 public:
  AntennaProblem(const PoseGraph& graph, std::span<const AntennaSighting> sightings)
      : sightings_(sightings), rest_(graph, AntennaError::SizeAtCompileTime) {
    rest_.add_edges();
    rest_.add_levels();
    for (const AntennaSighting& sighting : sightings_) {
      rows_.push_back(antenna_residual(sighting, graph.T_world_map(),
                                       graph.nodes()[graph.index_of(sighting.node)].T_map_node));
      roots_.push_back(root_information<3>(sighting.information));
    }
  }

  struct Solution {
    Eigen::VectorXd step;
    Eigen::Matrix4d covariance;
  };
  /// With each sighting's share times its weight.
  std::optional<Solution> solve(std::span<const double> weights) const {
    GraphInformation all = rest_;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Eigen::Matrix3d& root = roots_[i];
      all.add(root * rows_[i].residual,
              {{GraphInformation::kWorld, root * rows_[i].by_world},
               {all.place_of(sightings_[i].node), root * rows_[i].by_node},
               {all.further(), root * rows_[i].by_antenna}},
              sightings_[i].share * weights[i]);
    }
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(all.matrix());
    if (solver.info() != Eigen::Success) {
      return std::nullopt;
    }
    Eigen::MatrixXd antenna = Eigen::MatrixXd::Zero(all.size(), AntennaError::SizeAtCompileTime);
    antenna.bottomRows<4>().setIdentity();
    const Eigen::Matrix4d covariance = solver.solve(antenna).bottomRows<4>();
    return Solution{.step = solver.solve(-all.gradient()),
                    .covariance = 0.5 * (covariance + covariance.transpose())};
  }

  /// Of all sightings after that step; none: where they are.
  std::vector<double> chi2(const Eigen::VectorXd* step = nullptr) const {
    std::vector<double> values;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      Vector3d left = rows_[i].residual;
      if (step != nullptr) {
        left += rows_[i].by_world * step->segment<6>(GraphInformation::kWorld) +
                rows_[i].by_antenna * step->tail<4>();
        if (const auto node = rest_.place_of(sightings_[i].node)) {
          left += rows_[i].by_node * step->segment<6>(*node);
        }
      }
      values.push_back(left.dot(sightings_[i].gate_information * left));
    }
    return values;
  }

  /// The covariance of the estimate by what it is without each block of the sightings.
  std::optional<Eigen::Matrix4d> jackknife(const std::vector<double>& weights) const {
    std::vector<AntennaError> estimates;
    AntennaError mean = AntennaError::Zero();
    for (std::size_t block = 0; block < kBlocks; ++block) {
      std::vector<double> without = weights;
      const auto at = [&](std::size_t i) {
        return without.begin() + static_cast<std::ptrdiff_t>(i * weights.size() / kBlocks);
      };
      std::fill(at(block), at(block + 1), 0.0);
      const std::optional<Solution> solution = solve(without);
      if (!solution) {
        return std::nullopt;
      }
      estimates.emplace_back(solution->step.tail<4>());
      mean += estimates.back() / static_cast<double>(kBlocks);
    }
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
    for (const AntennaError& estimate : estimates) {
      covariance += (estimate - mean) * (estimate - mean).transpose();
    }
    return covariance * static_cast<double>(kBlocks - 1) / static_cast<double>(kBlocks);
  }

 private:
  std::span<const AntennaSighting> sightings_;
  GraphInformation rest_;  ///< edges and verticals
  std::vector<AntennaResidual> rows_;
  std::vector<Eigen::Matrix3d> roots_;
};

/// Geman and McClure's, of that squared width.
std::vector<double> weights_of(const std::vector<double>& chi2, double width2) {
  std::vector<double> weights;
  for (const double value : chi2) {
    const double near = width2 / (width2 + value);
    weights.push_back(near * near);
  }
  return weights;
}

/// Nine of ten are below it.
double most_of(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace

Vector3d p_node_antenna(const AntennaSighting& sighting, const AntennaError& error) {
  return sighting.T_node_lidar *
         (se3_exp(-error(kDelay) * sighting.twist) * (sighting.p_lidar_antenna + error.head<3>()));
}

AntennaResidual antenna_residual(const AntennaSighting& sighting,
                                 const Eigen::Isometry3d& T_world_map,
                                 const Eigen::Isometry3d& T_map_node) {
  const Vector3d p_node = p_node_antenna(sighting, AntennaError::Zero());
  const PositionFix fix{.node = sighting.node, .p_node = p_node, .p_world = sighting.p_world};
  const WhitenedTie<3> tie = FixResidual(fix).linearized(T_world_map, T_map_node);
  AntennaResidual row{
      .residual = tie.residual, .by_world = tie.by_world, .by_node = tie.by_node, .by_antenna = {}};
  const Vector3d turning = sighting.twist.tail<3>();
  const Eigen::Matrix3d R_world_lidar =
      T_world_map.linear() * T_map_node.linear() * sighting.T_node_lidar.linear();
  row.by_antenna.leftCols<3>() = R_world_lidar;
  row.by_antenna.col(kDelay) =
      -R_world_lidar * (sighting.twist.head<3>() + turning.cross(sighting.p_lidar_antenna));
  return row;
}

std::optional<AntennaEstimate> estimate_antenna(const PoseGraph& graph,
                                                std::span<const AntennaSighting> sightings) {
  if (sightings.size() < kFewestSightings) {
    return std::nullopt;
  }
  const AntennaProblem problem(graph, sightings);
  AntennaEstimate estimate{.chi2 = problem.chi2()};
  std::vector<double> weights;
  double width2 = std::max(kSightingGate, most_of(estimate.chi2));
  for (int at_the_gate = 0; at_the_gate < kRoundsAtTheGate; width2 /= kScaleStep) {
    width2 = std::max(kSightingGate, width2);
    at_the_gate += width2 == kSightingGate ? 1 : 0;
    weights = weights_of(estimate.chi2, width2);
    const auto solution = problem.solve(weights);
    if (!solution || !solution->step.allFinite()) {
      return std::nullopt;
    }
    estimate.error = solution->step.tail<4>();
    estimate.covariance = solution->covariance;
    estimate.chi2 = problem.chi2(&solution->step);
  }
  const std::optional<Eigen::Matrix4d> spread = problem.jackknife(weights);
  if (!spread) {
    return std::nullopt;
  }
  // Its standard deviations, where they are larger, at the same correlations.
  const Eigen::Vector4d larger =
      (spread->diagonal().cwiseQuotient(estimate.covariance.diagonal())).cwiseMax(1.0).cwiseSqrt();
  estimate.covariance = larger.asDiagonal() * estimate.covariance * larger.asDiagonal();
  return estimate;
}

std::array<AntennaParameter, 4> judged(const AntennaEstimate& estimate) {
  std::array<AntennaParameter, 4> parameters;
  for (int i = 0; i < AntennaError::SizeAtCompileTime; ++i) {
    const double useful = i == kDelay ? kUsefulDelay : kUsefulLever;
    const double least = i == kDelay ? kLeastDelay : kLeastLever;
    const double value = estimate.error(i);
    const double sigma = std::sqrt(estimate.covariance(i, i));
    const bool observable = sigma < useful;
    parameters[static_cast<std::size_t>(i)] = {
        .value = value,
        .sigma = sigma,
        .observable = observable,
        .significant = observable && std::abs(value) > std::max(least, kSignificant * sigma)};
  }
  return parameters;
}

}  // namespace adit
