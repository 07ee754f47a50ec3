// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <string_view>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/lie.hpp"

namespace adit::gpu {
struct RegistrationProgress;
struct RegistrationState;
struct mat3x4;
}  // namespace adit::gpu

namespace adit {

/// How an alignment ended. The pose may be used after `converged` and, but for the directions that
/// say so, `degenerate`; the others say why it may not.
enum class RegistrationStatus {
  converged,
  degenerate,          ///< converged, but some direction is held by no match: there the pose is the
                       ///< prior's, or the initial guess
  not_converged,       ///< still moving after max_iterations
  too_little_overlap,  ///< matched fraction below min_overlap
  too_few_points,      ///< matched points below min_inliers, or an empty source or target
  diverged,            ///< the step or the pose is not finite, or left the target's extent
  doubtful,            ///< found by a search, and rejected by its gating (slam/odometry/rejection)
};
/// For people.
std::string_view to_string(RegistrationStatus status);

/// The pose is an estimate: it converged, at least in the directions that the matches hold.
inline bool is_usable(RegistrationStatus status) {
  return status == RegistrationStatus::converged || status == RegistrationStatus::degenerate;
}

/// How well the matches hold a direction (after X-ICP, Tuna et al., T-RO 2023).
enum class Localizability {
  full,
  partial,  ///< by few matches: their information counts in part
  none,     ///< by none that agree: no information
};
/// The enumerator's name.
std::string_view to_string(Localizability localizability);

/// A direction of translation, or an axis of rotation about the source's origin.
struct ObservedDirection {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();        ///< unit, source frame
  Localizability localizability = Localizability::none;  ///< how well it is held
  double information = 0.0;       ///< 1/m^2 or 1/rad^2, the other directions free
  double support = 0.0;           ///< sum of the shares that agreeing matches have in it
  double information_each = 0.0;  ///< mean per match; 1/m^2
};

/// Result of aligning a source cloud with a target, at the final pose. Tangent vectors are [rho,
/// phi], right perturbations of T_target_source: the source's axes.
struct RegistrationResult {
  Eigen::Isometry3d T_target_source =
      Eigen::Isometry3d::Identity();  ///< maps the source's coordinates to the target's
  RegistrationStatus status = RegistrationStatus::too_few_points;  ///< how it ended
  Matrix6d hessian = Matrix6d::Zero();   ///< sum of J^T Omega J; 1/m^2, 1/(m rad), 1/rad^2
  Vector6d gradient = Vector6d::Zero();  ///< of the cost at that pose; 1/m, 1/rad
  /// What the matches say of the pose and no more: the Hessian without the information that
  /// regularised covariances claim in every direction. Without weak directions (their share),
  /// unless a prior was weighed against the matches. Never contains the prior.
  Matrix6d information = Matrix6d::Zero();
  /// Where a prior was weighed: the gradient of the matches' own cost, whose Hessian is
  /// `information`. The matches alone would be at -information^-1 pull. Zero elsewhere.
  Vector6d pull = Vector6d::Zero();
  /// Weakest first. Empty axes where nothing was assessed (kNdtToNdt, failures).
  std::array<ObservedDirection, 3> translation{};
  std::array<ObservedDirection, 3> rotation{};  ///< about the source's axes
  bool used_prior = false;                      ///< some steps were taken with the prior
  double cost = 0.0;  ///< sum of e^T Omega e over the matches; NDT: minus the score
  double residual_rms =
      0.0;  ///< m, root mean square distance along the target's normals over the matches
  double overlap = 0.0;   ///< inliers / source points
  int inliers = 0;        ///< source points with a match
  int matches = 0;        ///< sum over all points; more than inliers where neighbours are looked at
  int source_points = 0;  ///< that were aligned
  int iterations = 0;     ///< Gauss-Newton steps
  /// Matched points at the best other place that a search found, as a share of these; 0 where it
  /// found none.
  double competing_share = 0.0;
};

/// From information to a covariance that includes what matches do not show of their own errors
/// (docs/theory/registration.md): kappa (matches / inliers) (1 + max(0, rms / rms_expected - 1)) /
/// max(overlap, 0.3)^2 times the inverse of the information, plus floors. Matches of one point are
/// one measurement. With an `area`, times (surface of a match / area)^2 besides,
/// the quotient at most `most_sparse`.
struct CovarianceModel {
  double kappa = 1.0;  ///< see above
  /// m²; 0: whatever the surface of a match. Normals of sparse clouds are those of large patches,
  /// and wrong together (docs/theory/inertial.md, section 9).
  double area = 0.0;
  double most_sparse =
      std::numeric_limits<double>::infinity();  ///< bound of the quotient, see above
  double rms_expected = 0.03;                   ///< m
  double sigma_translation = 0.0;               ///< m, of what every alignment has in common
  double sigma_rotation = 0.0;                  ///< rad
  double sigma_unknown_translation = 10.0;      ///< m, in directions without information
  double sigma_unknown_rotation = 1.0;          ///< rad
};
/// As the model has it.
Matrix6d covariance(const RegistrationResult& result, const CovarianceModel& model);
/// The surface that stands behind a match, m²: the mean squared lever over which matches hold
/// rotations, over their number.
double surface_of_match(const RegistrationResult& result);
/// The factor on the inverse of the information in it.
double inflation(const RegistrationResult& result, const CovarianceModel& model);

/// The rows of a pose for the device (float32: the caller keeps it local), and back, rounded onto
/// SE(3).
gpu::mat3x4 to_device(const Eigen::Isometry3d& pose);
/// The pose of a device's rows.
Eigen::Isometry3d from_device(const gpu::mat3x4& rows);

/// The state an alignment starts from: the initial guess in the target's local frame, and the
/// information of the prior whose mean it is (right perturbation, the source's axes; zero: none).
/// `weighed`: the alignment starts in gpu::kPhaseConstrained, and takes no direction out.
gpu::RegistrationState initial_state(const Eigen::Isometry3d& guess,
                                     const Matrix6d& prior_information, bool weighed = false);

/// What a match counts in NDT, by Magnusson's score (2009, equation 6.8) for voxels of an edge (m):
/// `weight` exp(-`exponent` d²) at the Mahalanobis distance d.
struct NdtScore {
  double weight = 0.0;    ///< of a match at distance 0
  double exponent = 0.0;  ///< how fast it fades
};
/// For voxels of that edge (m).
NdtScore ndt_score(double voxel_size);

/// What the device left of one alignment.
struct DeviceAlignment {
  const gpu::RegistrationState& state;        ///< pose, Hessian and sums
  const gpu::RegistrationProgress& progress;  ///< iterations, and how they ended
};

/// Says how an alignment of `source_points` points ended. T_target_source is the device's pose, in
/// the target's local frame. `fictitious` is the information a match claims in every direction:
/// 1/2 for VGICP, else 0.
RegistrationResult read_registration(const DeviceAlignment& device, int source_points,
                                     double fictitious, const RegistrationConfig& config);

}  // namespace adit
