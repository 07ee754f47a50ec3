// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <variant>
#include <vector>

#include "adit/slam/fusion/inertial_event.hpp"
#include "adit/slam/fusion/sensor_start.hpp"
#include "adit/slam/fusion/sliding_graph.hpp"
#include "adit/slam/fusion/velocity_watch.hpp"

namespace adit {

/// What is known besides when a sweep is checked.
struct CheckContext {
  std::optional<NavState> before{};  ///< the last state that was fused
  bool timed = true;                 ///< as AlignmentsContradict
  bool sign_assumed = false;
  bool sure = true;  ///< nothing is known that the readings lack: no saturation, no gap
};

/// What came of fusing a sweep.
struct FusedSweep {
  std::variant<StateEstimate, FailedCheck> outcome;
  Innovation innovation{};       ///< the alignment's innovation; 0 degrees where there was none
  double innovation_gate = 0.0;  ///< bound of its nis: beyond it the alignment is an outlier
  /// How large errors are, in units of the variances that are promised: what the last innovations
  /// tell. 1 where there are too few.
  double scale = 1.0;
  std::vector<VelocityReport> velocities{};  ///< of the ways that were measured
  std::optional<MotionShares> shares{};      ///< of the motion since the last sweep
};

/// The pose of the lidar that the matches of an alignment measured, whatever prior it was weighed
/// against.
Eigen::Isometry3d matched_pose(const RegistrationResult& alignment);

/// Information of a predicted pose of the lidar with that covariance ([rho, phi], lidar axes), in
/// units of the matches' Hessian, of which `inflation` times the inverse is the covariance: for
/// Prediction::information.
Matrix6d pose_prior(const Matrix6d& lidar_covariance, double inflation);
/// With the least inflation that an alignment has: before there is one.
Matrix6d pose_prior(const Matrix6d& lidar_covariance);

/// What the matches of an alignment say is farther from a predicted pose than both may err by; of
/// that one `covariance` is of [rho, phi], lidar axes.
bool is_outlier(const Eigen::Isometry3d& T_map_lidar, const Matrix6d& covariance,
                const RegistrationResult& alignment);

/// A sensor that is fused: the sliding graph, with the sweep that is under way.
class FusedMotion {
 public:
  FusedMotion(const GraphSettings& settings, const SensorStart& start,
              const CalibrationSigma& calibration = {});

  /// The state of the newest sweep.
  const NavState& latest() const { return graph_.latest(); }

  /// The state at the end of the readings, which begin at the newest sweep. The sweep there is
  /// under way from now on, if the prediction can be.
  std::variant<StateEstimate, FailedCheck> predict(std::vector<ImuSample> readings);
  /// The prediction of the sweep under way; null if there is none.
  const StateEstimate* prediction() const { return pending_ ? &pending_->prediction : nullptr; }
  void forget_prediction() { pending_.reset(); }
  /// What the next alignment weighs against its matches: the information of this covariance of
  /// T_map_lidar, in units of their Hessian, scaled as the last alignment was.
  Matrix6d pose_prior(const Matrix6d& lidar_covariance) const {
    return adit::pose_prior(lidar_covariance, inflation_);
  }

  /// Fuses the sweep under way: by its alignment, or by inertia alone where that is null; and by
  /// the ways that were measured since the last sweep.
  FusedSweep fuse(const RegistrationResult* alignment, const Eigen::Isometry3d& T_body_lidar,
                  const CheckContext& context, std::vector<MeasuredDisplacement> ways = {});

  /// Sweeps fused in a row.
  int sweeps() const { return sweeps_; }

 private:
  struct Pending {
    std::vector<ImuSample> readings;
    StateEstimate prediction;
  };

  void note(const Innovation& innovation);
  double usual_innovation() const;
  double error_scale() const;
  std::optional<FailedCheck> failed_check(const StateEstimate& estimate,
                                          const CheckContext& context) const;

  SlidingGraph graph_;
  std::array<VelocityWatch, kVelocitySources> watches_;  ///< by VelocitySource
  std::optional<Pending> pending_;
  double inflation_;                ///< of the last alignment's covariance
  std::deque<double> innovations_;  ///< squared, a degree of freedom, of the last alignments
  int outliers_ = 0;                ///< in a row: innovations beyond the gate
  double surprises_ = 0.0;          ///< what they add up to
  double alone_ = 0.0;              ///< s without an alignment
  int sweeps_ = 0;
};

}  // namespace adit
