// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The residual of a measured relative pose Z between nodes i and j, a function of the error
// E = Z^-1 T_i^-1 T_j, and what robust kernels make of its square.
#pragma once

#include "adit/slam/core/lie.hpp"

namespace adit {

/// What of E is compared with zero. The conventions agree to first order but for the rotation's
/// scale: information matrices belong to the convention that they were written for.
enum class ResidualConvention {
  quaternion,  ///< (t, vector part of the unit quaternion): g2o's, rotations count half
  rotation,    ///< (t, Log R)
  logarithm,   ///< Log of SE(3)
};

/// E perturbed on the right: t + R rho, R Exp(phi).
struct BetweenResidual {
  Vector6d residual = Vector6d::Zero();  ///< ordered [translation, rotation], not whitened
  Matrix6d by_error = Matrix6d::Zero();  ///< its Jacobian by E's perturbation
};
BetweenResidual between_residual(const Eigen::Isometry3d& error, ResidualConvention convention);

/// How nodes i and j perturb E: A xi_i + xi_j. This is A.
Matrix6d error_by_first(const Eigen::Isometry3d& T_i_j);

enum class Kernel {
  none,
  pseudo_huber,  ///< linear beyond about `width` standard deviations
  dcs,           ///< dynamic covariance scaling: bounded, so that a wrong edge loses all influence
};

struct RobustLoss {
  Kernel kernel = Kernel::none;
  double width =
      3.549;  ///< in standard deviations: 95 % of true edges with 6 directions are within
};

/// The kernel's cost of a chi squared, with its derivatives. Without kernel: the chi squared, 1, 0.
struct KernelValue {
  double cost = 0.0;
  double weight = 1.0;     ///< first derivative
  double curvature = 0.0;  ///< second derivative
};
KernelValue apply(const RobustLoss& kernel, double chi2);

}  // namespace adit
