// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <variant>

#include "adit/slam/odometry/motion_model.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// The pose would not be finite.
struct PoseNotFinite {};

/// The sensor would have moved farther than it can in that time.
struct MovedTooFar {
  double distance = 0.0;   ///< m, since the last pose
  double elapsed = 0.0;    ///< s, since then
  double max_speed = 0.0;  ///< m/s, recovery.max_speed
};

/// A search found a place that could as well be farther along the ground: no match holds it there.
struct NotHeldAlong {};

/// A search found a place where fewer points match the submap than is usual.
struct OverlapFallsShort {
  double overlap = 0.0;  ///< share of the sweep's points, 0 to 1
  double usual = 0.0;    ///< mean over the sweeps before
};

/// A search found a place where points lie farther from the submap's surfaces than is usual.
struct ResidualTooLarge {
  double rms = 0.0;    ///< m
  double usual = 0.0;  ///< m, of the sweeps before
};

/// A search found two places.
struct TwoPlaces {
  double competing_share = 0.0;  ///< matched points at the other place over those at the chosen
};

/// After a silence, a search found a place that the sensor can hardly have moved to.
struct BeyondMotion {
  double distance = 0.0;  ///< m, since the last aligned sweep
  double turn = 0.0;      ///< rad, likewise
  double seconds = 0.0;   ///< s, since then
};

/// The silence was so long that the sensor may be where the submap does not reach.
struct BeyondReach {
  double seconds = 0.0;   ///< s, since the last aligned sweep
  double distance = 0.0;  ///< m, that it may have moved meanwhile
  double reach = 0.0;     ///< m, that the submap reaches
};

/// After a silence, too few sweeps before it show how well one fits.
struct NothingUsual {};

/// Why an alignment is rejected.
using Rejection =
    std::variant<PoseNotFinite, MovedTooFar, NotHeldAlong, OverlapFallsShort, ResidualTooLarge,
                 TwoPlaces, BeyondMotion, BeyondReach, NothingUsual>;

/// The alignment is within so many standard deviations of the prediction.
bool is_within(const RegistrationResult& alignment, const Prediction& prediction, double sigmas);

/// How well sweeps fit their submap when all is well: what each alignment is measured by. (An
/// alignment always ends somewhere; in a wrong place fewer points match.)
class UsualFit {
 public:
  /// An alignment from a trusted prediction that was used.
  void add(const RegistrationResult& alignment);
  /// With a new submap: nothing is usual any more.
  void forget() { *this = {}; }

  /// An alignment from a trusted prediction alone fits worse than usual, or failed: the place is
  /// to be searched for.
  bool falls_short(const RegistrationResult& alignment) const;

  /// Why an alignment that a search found or confirmed is rejected; none where it is accepted
  /// (docs/theory/odometry.md, section 3).
  std::optional<Rejection> rejection(const RegistrationResult& alignment,
                                     const Prediction& prediction) const;

  /// The same after a silence, `moved` from the last sweep that was aligned: the place must be one
  /// that the sensor can have moved to, and the only one that fits.
  std::optional<Rejection> rejection_after(const Silence& silence,
                                           const RegistrationResult& alignment,
                                           const Eigen::Isometry3d& moved) const;

 private:
  int alignments_ = 0;
  double overlap_ = 0.0;
  double rms_ = 0.0;  ///< m
};

}  // namespace adit
