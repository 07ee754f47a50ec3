// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "adit/slam/core/imu_noise.hpp"
#include "adit/slam/fusion/graph_estimate.hpp"
#include "adit/slam/fusion/motion_shares.hpp"
#include "adit/slam/fusion/pose_factor.hpp"
#include "adit/slam/fusion/state_chain.hpp"
#include "adit/slam/fusion/state_prior.hpp"
#include "adit/slam/inertial/measured_displacement.hpp"
#include "adit/slam/inertial/preintegration.hpp"

namespace adit {

struct GraphSettings {
  ImuNoise noise;
  /// Random walk of gravity's direction in the map, as the map drifts: rad/√s.
  double gravity_walk = 1e-4;
  /// And by the way made: rad/√m.
  double gravity_walk_way = 0.0;
  /// Fixed lag: the oldest state is marginalised once there are more than this.
  int lag = 20;
  /// Greater than 0, instead of the lag: once there are this many, all but the newest are
  /// marginalised (LG-SLAM's reset, there of 100).
  int reset = 0;
  bool robust = true;  ///< Huber's kernel on pose measurements
  int max_iterations = 6;
};

/// The inertial states of the last sweeps, tied by preintegrated readings and biases that walk, and
/// held by measured poses (LG-SLAM's sliding graph; docs/theory/inertial.md). Deterministic.
class SlidingGraph {
 public:
  explicit SlidingGraph(const GraphSettings& settings) : settings_(settings) {}

  /// Forgets everything but this prior.
  void start(const StatePrior& prior);
  bool started() const { return !nodes_.empty(); }
  /// The newest state; the graph is started.
  const NavState& latest() const { return nodes_.back().state; }
  GraphEstimate latest_estimate() const;
  int size() const { return static_cast<int>(nodes_.size()); }
  /// What each source contributes to the motion that led to the newest state; none after a start.
  const std::optional<MotionShares>& shares() const { return shares_; }

  /// Where the readings lead from the newest state, with covariance. They begin at its stamp.
  GraphEstimate predict(const std::vector<ImuSample>& readings) const;

  /// A new state at the end of the readings, which begin at the newest one's stamp, and what was
  /// measured of its pose, and of the way since the newest one, if anything; optimises all states
  /// and marginalises what is past the lag. After a failure the graph must be started again.
  GraphEstimate add(std::vector<ImuSample> readings,
                    const std::optional<PoseMeasurement>& measurement,
                    std::vector<MeasuredDisplacement> ways = {});

 private:
  struct Node {
    NavState state;
    std::optional<PoseMeasurement> measurement;
    std::vector<ImuSample> readings;  ///< from the node before; empty for the first
    Preintegration between;           ///< their preintegration
    double gravity_sigma = 0.0;       ///< of what gravity's direction has walked meanwhile, rad
    std::vector<MeasuredDisplacement> ways{};  ///< from the node before, by sensors of velocities
  };

  double gravity_sigma(const NavState& from, const NavState& to, double duration) const;
  StateQuadratic state_quadratic(size_t i, const NavState& state) const;
  LinkQuadratic link_quadratic(size_t to, const NavState& from_state,
                               const NavState& to_state) const;
  ChainQuadratic linearized(const std::vector<NavState>& states) const;
  std::vector<NavState> states() const;
  StepInformation newest_step() const;
  void append(Node node);
  GraphEstimate optimize();
  void integrate_stale_again();
  /// False: the states do not determine what is left.
  bool marginalize_first();

  GraphSettings settings_;
  StatePrior prior_;  ///< on the first node
  std::deque<Node> nodes_;
  ChainQuadratic chain_;     ///< linearised at the nodes' estimates
  StateQuadratic marginal_;  ///< its marginal on the newest node
  MotionLedger ledger_;
  std::optional<MotionShares> shares_;
};

}  // namespace adit
