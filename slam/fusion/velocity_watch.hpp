// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>

#include "adit/slam/fusion/graph_estimate.hpp"
#include "adit/slam/inertial/measured_displacement.hpp"

namespace adit {

/// What a sensor of velocities measured between two sweeps, against what was predicted there.
struct VelocityInnovation {
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();   ///< mean velocity as it was read, body axes
  Eigen::Vector3d predicted = Eigen::Vector3d::Zero();  ///< of the sensor, body axes, m/s
  Eigen::Vector3d error = Eigen::Vector3d::Zero();      ///< prediction from calibrated reading, m/s
  double sigma = 0.0;                                   ///< m/s, of what was read, on its best axis
  double nis = 0.0;  ///< normalised, squared: chi squared with three degrees of freedom
};

/// `from`: the state before; `prediction`: where the readings of the inertial sensor lead.
VelocityInnovation innovation(const MeasuredDisplacement& measured, const NavState& from,
                              const StateEstimate& prediction);

/// The turn and the scale that make the most of what a sensor of velocities reads.
struct VelocityComparison {
  double speed = 0.0;           ///< m/s, root mean square of what was predicted
  double measured_speed = 0.0;  ///< m/s, the same of what was read
  double scale = 0.0;           ///< by which readings are multiplied for the best fit
  double turn = 0.0;            ///< rad, by which the direction that most go in is turned for that
  double left = 0.0;            ///< m/s, root mean square of what remains then
};

/// An error of several sweeps in a row that has the same direction: wheels that slip.
struct LastingError {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< m/s, body axes
  std::size_t sweeps = 0;                          ///< up to the newest one
  double chi2 = 0.0;  ///< of the mean, with noise that averages out: three degrees of freedom
};

/// What a sweep reports of a sensor of velocities.
struct VelocityReport {
  VelocitySource source = VelocitySource::sensor;
  VelocityInnovation innovation;  ///< of the way since the last sweep
  /// (m/s)², of the mean velocity, body axes, as it is fused.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  bool on_trial = false;  ///< the body has hardly moved since it came
  bool refused = false;   ///< it is not this body's velocity
  bool slips = false;     ///< its lasting error is one that 99.9 % of honest ones do not have
  std::optional<VelocityComparison> comparison{};  ///< of the last seconds of motion

  bool fused() const { return !on_trial && !refused; }
};

/// Judges a sensor of velocities by its innovations while the body moves: how much worse than it
/// says it is, and whether it measures this body's velocity at all.
class VelocityWatch {
 public:
  /// `scale_sigma`: VelocityConfig::scale_sigma.
  explicit VelocityWatch(double scale_sigma) : scale_sigma_(scale_sigma) {}

  /// Judges the way, and gives it the covariance that its source has earned.
  VelocityReport judge(MeasuredDisplacement& measured, const NavState& from,
                       const StateEstimate& prediction);

 private:
  /// An innovation with what makes it up, (m/s)², body axes.
  struct Remembered {
    VelocityInnovation innovation;
    /// Of what was read: independent from one sweep to the next.
    Eigen::Matrix3d noise = Eigen::Matrix3d::Zero();
    /// Of the predicted velocity and the calibration: the same for sweeps in a row.
    Eigen::Matrix3d common = Eigen::Matrix3d::Zero();
  };

  /// False: the body hardly moves, and it is not kept.
  bool note(const Remembered& one);
  /// What the variances that are promised are to be multiplied by, at least 1.
  double variance_scale() const;
  /// Of the last sweeps; of those numbers of them the one that is least likely to be noise.
  LastingError lasting_error() const;
  /// Too little motion has shown that it measures this body's velocity.
  bool on_trial() const;
  /// The last innovations are neither noise nor an error of scale or mounting that is estimated.
  bool contradicted() const;
  /// Of the last innovations; nothing where there are too few.
  std::optional<VelocityComparison> comparison() const;

  double scale_sigma_;
  std::deque<Remembered> moving_;
};

}  // namespace adit
