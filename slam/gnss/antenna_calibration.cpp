// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/antenna_calibration.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>

#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/slam/graph/graph_information.hpp"

namespace adit {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr std::size_t kFewestSightings = 10;
constexpr double kScaleStep = 4.0;  // of the kernel's squared width, from round to round
constexpr int kRoundsAtTheGate = 3;
constexpr std::size_t kBlocks = 5;    // of the jackknife
constexpr double kSignificant = 4.0;  // standard deviations
// What is known no better is of no use, and what is smaller makes no difference to a map: of the
// lever arm (m) and of the delay (s).
constexpr double kUsefulLever = 0.1;
constexpr double kUsefulDelay = 0.05;
constexpr double kKnown = 8.0;  // standard deviations: of a large error, which may be known worse
constexpr double kLeastLever = 0.05;
constexpr double kLeastDelay = 0.01;

// Of a fix's variance, what is another error each time.
constexpr double kWhiteShare = 0.25;
// Errors of receivers that state other variances than this many times each other's have nothing to
// do with each other: another kind of fix.
constexpr double kOtherKind = 2.0;

constexpr Index kAntennaSize = AntennaError::SizeAtCompileTime;
/// World, node, slow error, antenna.
constexpr int kSightingSize = 6 + 6 + 3 + AntennaError::SizeAtCompileTime;

/// Fixes of a node in a row that share their slow error.
struct SightingGroup {
  std::size_t begin = 0;
  std::size_t end = 0;
  double kept = 0.0;  ///< of the slow error of the group before; 0: it has nothing to do with that
};

std::vector<SightingGroup> groups_of(std::span<const AntennaSighting> sightings,
                                     double correlation) {
  std::vector<SightingGroup> groups;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const double ratio =
        i == 0 ? 0.0 : sightings[i].covariance.trace() / sightings[i - 1].covariance.trace();
    const bool alike = ratio < kOtherKind && ratio > 1.0 / kOtherKind;
    if (alike && sightings[i].node == sightings[i - 1].node) {
      groups.back().end = i + 1;
      continue;
    }
    const double apart = alike ? sightings[i].time - sightings[groups.back().begin].time : 0.0;
    groups.push_back(
        {.begin = i, .end = i + 1, .kept = apart > 0.0 ? std::exp(-apart / correlation) : 0.0});
  }
  return groups;
}

/// The slow error's square root: of one with unit variances, m.
Eigen::Matrix3d slow_root(const AntennaSighting& sighting) {
  const Eigen::Matrix3d slow = (1.0 - kWhiteShare) * sighting.covariance;
  return Eigen::LLT<Eigen::Matrix3d>(slow).matrixL();
}

class AntennaProblem {
 public:
  AntennaProblem(const PoseGraph& graph, std::span<const AntennaSighting> sightings,
                 const ReceiverNoise& noise)
      : sightings_(sightings),
        groups_(groups_of(sightings, noise.correlation)),
        rest_(graph, 3 * static_cast<Index>(groups_.size()) + kAntennaSize) {
    rest_.add_edges();
    rest_.add_levels();
    add_slow_errors();
    for (const AntennaSighting& sighting : sightings_) {
      rows_.push_back(antenna_residual(sighting, graph.T_world_map(),
                                       graph.nodes()[graph.index_of(sighting.node)].T_map_node));
      information_.push_back(fix_information(kWhiteShare * sighting.covariance, noise.height));
      const Eigen::Matrix3d with_shape =
          sighting.covariance + kShapeNoise * kShapeNoise * Eigen::Matrix3d::Identity();
      gate_.push_back(fix_information(with_shape, noise.height));
    }
  }

  struct Solution {
    Eigen::VectorXd step;
    Eigen::Matrix4d covariance;

    AntennaError error() const { return step.tail<4>(); }
  };
  /// With sightings that count so many times.
  std::optional<Solution> solve(std::span<const double> weights) const {
    GraphInformation all = rest_;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      Eigen::Matrix<double, kSightingSize, kSightingSize> information;
      information.setZero();
      Eigen::Matrix<double, kSightingSize, 1> gradient;
      gradient.setZero();
      for (std::size_t i = groups_[g].begin; i < groups_[g].end; ++i) {
        Eigen::Matrix<double, 3, kSightingSize> by;
        by << rows_[i].by_world, rows_[i].by_node, -slow_root(sightings_[i]), rows_[i].by_antenna;
        const auto weighted = (weights[i] * by.transpose() * information_[i]).eval();
        information += weighted * by;
        gradient += weighted * rows_[i].residual;
      }
      all.add({{GraphInformation::kWorld, 6},
               {all.place_of(sightings_[groups_[g].begin].node), 6},
               {slow_error(g), 3},
               {all.size() - kAntennaSize, kAntennaSize}},
              information, gradient);
    }
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(all.matrix());
    if (solver.info() != Eigen::Success) {
      return std::nullopt;
    }
    Eigen::MatrixXd antenna = Eigen::MatrixXd::Zero(all.size(), kAntennaSize);
    antenna.bottomRows<4>().setIdentity();
    const Eigen::Matrix4d covariance = solver.solve(antenna).bottomRows<4>();
    Solution solution{.step = solver.solve(-all.gradient()),
                      .covariance = 0.5 * (covariance + covariance.transpose())};
    return solution.step.allFinite() ? std::optional(std::move(solution)) : std::nullopt;
  }

  /// How far sightings lie from the graph after that step, the slow error left in: chi squared.
  std::vector<double> chi2(const Eigen::VectorXd& step) const {
    std::vector<double> values;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Vector3d left = left_by(step, i);
      values.push_back(left.dot(gate_[i] * left));
    }
    return values;
  }
  /// Where they are.
  std::vector<double> chi2() const { return chi2(Eigen::VectorXd::Zero(rest_.size())); }

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
      estimates.push_back(solution->error());
      mean += estimates.back() / static_cast<double>(kBlocks);
    }
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
    for (const AntennaError& estimate : estimates) {
      covariance += (estimate - mean) * (estimate - mean).transpose();
    }
    return covariance * static_cast<double>(kBlocks - 1) / static_cast<double>(kBlocks);
  }

  /// How many times their variances the receiver's errors turn out to have: the slow and the white
  /// ones' chi squared for each row of the sightings that count.
  double variance_factor(const Eigen::VectorXd& step, std::span<const double> weights) const {
    double chi2 = 0.0;
    double rows = 0.0;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const Vector3d slow = step.segment<3>(slow_error(g));
      const double kept = groups_[g].kept;
      const Vector3d before =
          kept > 0.0 ? Vector3d(step.segment<3>(slow_error(g - 1))) : Vector3d::Zero();
      chi2 += (slow - kept * before).squaredNorm() / (1.0 - kept * kept);
      for (std::size_t i = groups_[g].begin; i < groups_[g].end; ++i) {
        const Vector3d left = left_by(step, i) - slow_root(sightings_[i]) * slow;
        chi2 += weights[i] * left.dot(information_[i] * left);
        rows += 3.0 * weights[i];
      }
    }
    return chi2 / std::max(rows, 1.0);
  }

 private:
  Vector3d left_by(const Eigen::VectorXd& step, std::size_t i) const {
    Vector3d left = rows_[i].residual +
                    rows_[i].by_world * step.segment<6>(GraphInformation::kWorld) +
                    rows_[i].by_antenna * step.tail<4>();
    if (const auto node = rest_.place_of(sightings_[i].node)) {
      left += rows_[i].by_node * step.segment<6>(*node);
    }
    return left;
  }

  Index slow_error(std::size_t group) const {
    return rest_.further() + 3 * static_cast<Index>(group);
  }

  void add_slow_errors() {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      const double kept = groups_[g].kept;
      Eigen::Matrix<double, 3, 6> by;
      by << -kept * Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity();
      const GraphInformation::Place before =
          kept > 0.0 ? GraphInformation::Place(slow_error(g - 1)) : std::nullopt;
      rest_.add({{before, 3}, {slow_error(g), 3}}, by.transpose() * by / (1.0 - kept * kept),
                Vector6d::Zero());
    }
  }

  std::span<const AntennaSighting> sightings_;
  std::vector<SightingGroup> groups_;
  GraphInformation rest_;  ///< edges, verticals and how slow errors change
  std::vector<AntennaResidual> rows_;
  std::vector<Eigen::Matrix3d> information_;  ///< of errors that are others each time, 1/m^2
  std::vector<Eigen::Matrix3d> gate_;
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
                                                std::span<const AntennaSighting> sightings,
                                                const ReceiverNoise& noise) {
  if (sightings.size() < kFewestSightings) {
    return std::nullopt;
  }
  const AntennaProblem problem(graph, sightings, noise);
  AntennaEstimate estimate;
  std::vector<double> chi2 = problem.chi2();
  std::vector<double> weights;
  double width2 = std::max(kFixGate, most_of(chi2));
  for (int at_the_gate = 0; at_the_gate < kRoundsAtTheGate; width2 /= kScaleStep) {
    width2 = std::max(kFixGate, width2);
    at_the_gate += width2 == kFixGate ? 1 : 0;
    weights = weights_of(chi2, width2);
    const auto solution = problem.solve(weights);
    if (!solution) {
      return std::nullopt;
    }
    estimate.error = solution->error();
    estimate.covariance =
        std::max(1.0, problem.variance_factor(solution->step, weights)) * solution->covariance;
    chi2 = problem.chi2(solution->step);
  }
  for (const double value : chi2) {
    estimate.agrees.push_back(value < kFixGate);
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
    const bool observable = sigma < useful || kKnown * sigma < std::abs(value);
    parameters[static_cast<std::size_t>(i)] = {
        .value = value,
        .sigma = sigma,
        .observable = observable,
        .significant = observable && std::abs(value) > std::max(least, kSignificant * sigma)};
  }
  return parameters;
}

}  // namespace adit
