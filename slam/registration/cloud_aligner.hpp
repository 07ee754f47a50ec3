// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/registration/batch_aligner.hpp"
#include "adit/slam/registration/competing_poses.hpp"
#include "adit/slam/registration/overhead_search.hpp"

namespace adit {

/// Why a pose of two clouds is not to be used.
enum class AlignmentRefusal {
  none,                ///< it may be used
  nothing_to_align,    ///< a cloud has too few points
  nothing_found,       ///< no guess, and nothing rises that could tell the places apart
  not_converged,       ///< still moving, or led away
  too_little_overlap,  ///< too small a share of b's points lies on a
  poor_fit,            ///< matched points lie too far from a's surfaces
  degenerate,          ///< a direction is held by no match
  ambiguous,           ///< another pose fits as well
};
/// The enumerator's name.
std::string_view to_string(AlignmentRefusal refusal);

/// How clouds are aligned; lengths in m.
struct CloudAlignerSettings {
  RegistrationMethod method = RegistrationMethod::vgicp;  ///< how clouds are compared
  double r_input = 0.0;      ///< voxel size of the down-sampling; 0: by each cloud's extent, 0.05
                             ///< to 0.25. Voxels of the levels are 16, 8, 4 and 2 times as large
  double min_overlap = 0.4;  ///< share of b's points that must lie on a
  double most_rms = 0.4;     ///< of the matches' distances, in voxels of the finest level
  OverheadSearchSettings search{};  ///< where there is no guess
};

/// A cloud made ready: on the device, with its voxel maps, and from above. Made by
/// CloudAligner::prepare().
struct AlignableCloud {
  double r_input = 0.0;    ///< m
  std::size_t points = 0;  ///< those that were given
  SurfaceCloud cloud;      ///< down-sampled, with surfaces
  AlignmentTarget coarse;  ///< all levels but the last two
  AlignmentTarget fine;    ///< the last two
  AlignmentTarget judge;   ///< what results are judged on
  OverheadView above;      ///< for the search without a guess
};

/// Two clouds whose relative pose is wanted. They must live until align() returns.
struct CloudPair {
  const AlignableCloud* a = nullptr;         ///< stays where it is
  const AlignableCloud* b = nullptr;         ///< is placed in a's frame
  std::optional<Eigen::Isometry3d> guess{};  ///< T_a_b, to some 2 m and 20 degrees; none: searched
};

/// The relative pose of two clouds, or why there is none to rely on.
struct CloudAlignment {
  AlignmentRefusal refusal = AlignmentRefusal::none;        ///< none: the pose is usable
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();  ///< maps b's coordinates to a's
  /// Of T_a_b, right perturbation [rho, phi] in b's axes; m and rad.
  Matrix6d covariance = Matrix6d::Identity();
  /// What was measured at that pose: overlap, residual, directions, iterations.
  RegistrationResult registration{};
  std::optional<CompetingPose> competing{};  ///< the other pose, where it is ambiguous
  std::size_t poses_tried = 0;               ///< that were aligned
};

/// Aligns pairs of clouds, from a guess or from nothing, many at once, and refuses what it cannot
/// vouch for. The same clouds and guesses on the same device give the same bits.
class CloudAligner {
 public:
  /// The context outlives it.
  explicit CloudAligner(engine::Context& context, const CloudAlignerSettings& settings = {});
  ~CloudAligner();
  CloudAligner(CloudAligner&&) noexcept;
  CloudAligner& operator=(CloudAligner&&) noexcept;

  /// Points that are not finite or (0, 0, 0) are dropped. `viewpoint` (m, the cloud's frame) is
  /// where the sensor was; none: the frame's origin, where that lies among the points, else their
  /// middle. Throws engine::Error for more points than kLargestSweep, engine::OutOfMemory.
  AlignableCloud prepare(std::span<const Point> points,
                         const std::optional<Eigen::Vector3d>& viewpoint = std::nullopt,
                         const Checkpoint& checkpoint = {});

  /// A result a pair, in their order. Throws engine::OutOfMemory, engine::DeviceLost, and what the
  /// checkpoint throws; the next call works.
  std::vector<CloudAlignment> align(std::span<const CloudPair> pairs,
                                    const Checkpoint& checkpoint = {});

 private:
  struct Size;
  struct Sizes;

  Size& of_size(double r_input);
  std::vector<CloudAlignment> align_some(Size& size, std::span<const CloudPair> pairs,
                                         const Checkpoint& checkpoint) const;

  engine::Context* context_;
  CloudAlignerSettings settings_;
  std::unique_ptr<Sizes> sizes_;
};

}  // namespace adit
