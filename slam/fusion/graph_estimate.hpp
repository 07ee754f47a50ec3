// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the sliding graph knows of a state, and what a measurement says to that.
#pragma once

#include <string_view>
#include <variant>

#include "adit/slam/fusion/pose_factor.hpp"

namespace adit {

/// A state with its covariance, in the order of tangent vectors.
struct StateEstimate {
  NavState state;
  StateMatrix covariance = StateMatrix::Zero();
  int iterations = 0;  ///< optimisation's iterations; 0 for predictions
  bool converged = true;
};

/// Why the graph has no estimate.
enum class GraphFailure {
  undetermined,  ///< readings and measurements do not determine a state, or only within rounding
  not_finite,
};
std::string_view to_string(GraphFailure failure);

/// An estimate is finite, and its covariance positive.
using GraphEstimate = std::variant<StateEstimate, GraphFailure>;

/// How far a measured pose is from a prediction.
struct Innovation {
  Vector6d error = Vector6d::Zero();  ///< prediction from measurement, [rho, phi], body axes
  double nis = 0.0;                   ///< normalised: chi squared with this many degrees of freedom
  int degrees = 0;
  /// The error in units of its own standard deviations, along axes that stay: its squared norm is
  /// nis, to first order. White where the filter's model holds.
  Vector6d whitened = Vector6d::Zero();
};
Innovation innovation(const StateEstimate& prediction, const PoseMeasurement& measurement);

/// The estimate with the covariance that this information gives it.
GraphEstimate estimated(StateEstimate estimate, const StateMatrix& information);

}  // namespace adit
