// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/sliding_graph.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "adit/slam/fusion/convergence.hpp"
#include "adit/slam/fusion/imu_factor.hpp"
#include "adit/slam/fusion/velocity_factor.hpp"
#include "adit/slam/fusion/walk_factor.hpp"

namespace adit {
namespace {

constexpr double kFirstDamping = 1e-6;
constexpr double kLargestDamping = 1e3;

std::vector<NavState> moved(const std::vector<NavState>& states,
                            const std::vector<StateVector>& steps) {
  std::vector<NavState> result;
  for (size_t i = 0; i < states.size(); ++i) {
    result.push_back(retract(states[i], steps[i]));
  }
  return result;
}

}  // namespace

void SlidingGraph::start(const StatePrior& prior) {
  prior_ = prior;
  nodes_.clear();
  chain_ = {};
  append({.state = prior.origin,
          .measurement = {},
          .readings = {},
          .between = {},
          .gravity_sigma = {}});
  marginal_ = chain_.states.front();
  ledger_.start(marginal_.h);
  shares_.reset();
}

void SlidingGraph::append(Node node) {
  nodes_.push_back(std::move(node));
  const size_t i = nodes_.size() - 1;
  chain_.states.push_back(state_quadratic(i, nodes_[i].state));
  if (i > 0) {
    chain_.links.push_back(link_quadratic(i, nodes_[i - 1].state, nodes_[i].state));
  }
}

GraphEstimate SlidingGraph::latest_estimate() const {
  return estimated({.state = latest()}, marginal_.h);
}

GraphEstimate SlidingGraph::predict(const std::vector<ImuSample>& readings) const {
  const Preintegration between = preintegrate(readings, latest().bias, settings_.noise);
  StateEstimate prediction{.state = adit::predict(latest(), between)};
  prediction.state.stamp = readings.empty() ? latest().stamp : readings.back().stamp;
  if (between.duration <= 0.0) {
    return latest_estimate();
  }
  LinkQuadratic link = quadratic(imu_factor(between, latest(), prediction.state));
  link += quadratic(walk_factor(settings_.noise,
                                gravity_sigma(latest(), prediction.state, between.duration),
                                between.duration, latest(), prediction.state));
  const std::optional<StateQuadratic> left = eliminated(marginal_, link);
  if (!left) {
    return GraphFailure::undetermined;
  }
  return estimated(prediction, left->h);
}

GraphEstimate SlidingGraph::add(std::vector<ImuSample> readings,
                                const std::optional<PoseMeasurement>& measurement,
                                std::vector<MeasuredDisplacement> ways) {
  Node node;
  node.between = preintegrate(readings, latest().bias, settings_.noise);
  if (node.between.duration <= 0.0) {
    throw std::logic_error("a new state of the sliding graph needs readings of some duration");
  }
  node.state = adit::predict(latest(), node.between);
  node.gravity_sigma = gravity_sigma(latest(), node.state, node.between.duration);
  node.state.stamp = readings.back().stamp;
  node.readings = std::move(readings);
  node.measurement = measurement;
  node.ways = std::move(ways);
  append(std::move(node));

  const GraphEstimate estimate = optimize();
  if (std::holds_alternative<GraphFailure>(estimate)) {
    return estimate;
  }
  shares_ = ledger_.add(newest_step(), nodes_[nodes_.size() - 2].state, latest());
  const bool resets = settings_.reset > 0 && size() >= settings_.reset;
  const int keep = settings_.reset > 0 ? (resets ? 1 : settings_.reset) : settings_.lag;
  while (size() > keep) {
    if (!marginalize_first()) {
      return GraphFailure::undetermined;
    }
  }
  return estimate;
}

std::vector<NavState> SlidingGraph::states() const {
  std::vector<NavState> result;
  for (const Node& node : nodes_) {
    result.push_back(node.state);
  }
  return result;
}

double SlidingGraph::gravity_sigma(const NavState& from, const NavState& to,
                                   double duration) const {
  const double metres = (to.T_map_body.translation() - from.T_map_body.translation()).norm();
  return std::sqrt(std::pow(settings_.gravity_walk, 2) * duration +
                   std::pow(settings_.gravity_walk_way, 2) * metres);
}

StateQuadratic SlidingGraph::state_quadratic(size_t i, const NavState& state) const {
  StateQuadratic sum;
  if (i == 0) {
    sum += quadratic(prior_factor(prior_, state));
  }
  if (const auto& measurement = nodes_[i].measurement) {
    sum += quadratic(pose_factor(*measurement, state),
                     settings_.robust ? huber_width(measurement->known_directions) : 0.0);
  }
  return sum;
}

LinkQuadratic SlidingGraph::link_quadratic(size_t to, const NavState& from_state,
                                           const NavState& to_state) const {
  const Preintegration& between = nodes_[to].between;
  LinkQuadratic sum = quadratic(imu_factor(between, from_state, to_state));
  sum += quadratic(walk_factor(settings_.noise, nodes_[to].gravity_sigma, between.duration,
                               from_state, to_state));
  for (const MeasuredDisplacement& way : nodes_[to].ways) {
    const LinkFactor<3> factor = velocity_factor(way, from_state, to_state);
    sum += quadratic(factor, velocity_kernel(factor));
  }
  return sum;
}

// The walk's last three rows are of the velocity sensor's calibration.
StepInformation SlidingGraph::newest_step() const {
  const Node& node = nodes_.back();
  const NavState& from = nodes_[nodes_.size() - 2].state;
  StepInformation step;
  step.range = state_quadratic(nodes_.size() - 1, node.state);
  LinkFactor<12> walk =
      walk_factor(settings_.noise, node.gravity_sigma, node.between.duration, from, node.state);
  LinkFactor<3> calibration;
  calibration.by_from = walk.by_from.bottomRows<3>();
  calibration.by_to = walk.by_to.bottomRows<3>();
  walk.by_from.bottomRows<3>().setZero();
  walk.by_to.bottomRows<3>().setZero();
  step.imu = quadratic(imu_factor(node.between, from, node.state));
  step.imu += quadratic(walk);
  step.velocity = quadratic(calibration);
  for (const MeasuredDisplacement& way : node.ways) {
    const LinkFactor<3> factor = velocity_factor(way, from, node.state);
    (way.source == VelocitySource::doppler ? step.doppler : step.velocity) +=
        quadratic(factor, velocity_kernel(factor));
  }
  return step;
}

ChainQuadratic SlidingGraph::linearized(const std::vector<NavState>& states) const {
  ChainQuadratic chain;
  for (size_t i = 0; i < states.size(); ++i) {
    chain.states.push_back(state_quadratic(i, states[i]));
    if (i > 0) {
      chain.links.push_back(link_quadratic(i, states[i - 1], states[i]));
    }
  }
  return chain;
}

// Levenberg-Marquardt; undamped steps are Gauss-Newton's, and damping begins where one fails. A
// step too short to matter is not made: so the chain stays linearised where its states are.
GraphEstimate SlidingGraph::optimize() {
  StateEstimate estimate;
  estimate.converged = false;
  integrate_stale_again();
  std::vector<NavState> best = states();
  std::optional<StateQuadratic> marginal;
  double damping = 0.0;
  while (estimate.iterations < settings_.max_iterations && !estimate.converged &&
         damping <= kLargestDamping) {
    ++estimate.iterations;
    marginal.reset();
    if (const auto found = minimum(chain_, damping)) {
      marginal = damping > 0.0 ? std::nullopt : std::optional(found->last);
      estimate.converged = is_negligible(expected_decrease(chain_, found->steps));
      if (estimate.converged) {
        break;
      }
      const std::vector<NavState> candidate = moved(best, found->steps);
      ChainQuadratic there = linearized(candidate);
      const double cost = chain_.cost();
      if (there.cost() <= cost) {
        estimate.converged = has_settled(cost, there.cost());
        best = candidate;
        chain_ = std::move(there);
        marginal.reset();
        damping *= 0.1;
        continue;
      }
    }
    damping = std::max(10.0 * damping, kFirstDamping);
  }
  for (size_t i = 0; i < best.size(); ++i) {
    nodes_[i].state = best[i];
  }
  marginal = marginal ? marginal : marginal_of_last(chain_);
  if (!marginal) {
    return GraphFailure::undetermined;
  }
  marginal_ = *marginal;
  estimate.state = latest();
  return estimated(estimate, marginal_.h);
}

void SlidingGraph::integrate_stale_again() {
  for (size_t i = 1; i < nodes_.size(); ++i) {
    const NavState& before = nodes_[i - 1].state;
    if (is_stale(nodes_[i].between, before.bias)) {
      nodes_[i].between = preintegrate(nodes_[i].readings, before.bias, settings_.noise);
      chain_.links[i - 1] = link_quadratic(i, before, nodes_[i].state);
    }
  }
}

bool SlidingGraph::marginalize_first() {
  const auto left = eliminated(chain_.states[0], chain_.links[0]);
  if (!left) {
    return false;
  }
  prior_ = prior_from(nodes_[1].state, *left);
  nodes_.pop_front();
  nodes_.front().readings.clear();
  chain_.states.erase(chain_.states.begin());
  chain_.links.erase(chain_.links.begin());
  chain_.states.front() = state_quadratic(0, nodes_.front().state);
  return true;
}

}  // namespace adit
