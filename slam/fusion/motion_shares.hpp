// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What each sensor contributes to the estimated motion (docs/theory/velocity.md, section 7).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "adit/slam/fusion/linearization.hpp"
#include "adit/slam/inertial/measured_displacement.hpp"

namespace adit {

/// Where the sliding graph's information comes from.
enum class MotionSource {
  range,     ///< alignments of sweeps
  imu,       ///< readings, and how far the biases and gravity's direction can change
  velocity,  ///< wheels, a radar or another odometry, with its calibration
  doppler,   ///< Doppler speeds of the range sensor
  start,     ///< what was known or assumed when the IMU started
};
inline constexpr std::size_t kMotionSources = 5;

/// Parts of a motion: horizontally along the path and across it, up, and the three rotations.
enum class MotionPart { along, across, up, rotation };
inline constexpr std::size_t kMotionParts = 4;
/// The enumerator's name.
constexpr std::string_view to_string(MotionPart part) {
  constexpr std::array<std::string_view, kMotionParts> kNames = {"along", "across", "up",
                                                                 "rotation"};
  return kNames.at(static_cast<std::size_t>(part));
}

/// Shares of the information about the motion of the body since the last sweep: those of a part add
/// up to 1 over all sources. A share is the weight that the source has in the estimate, as of two
/// measurements with variances a and b the first has b / (a + b).
struct MotionShares {
  std::array<std::array<double, kMotionParts>, kMotionSources> of{};  ///< by source, then by part
  /// The body has moved horizontally by more than three standard deviations: else there is no path,
  /// and `along` and `across` are 0.
  bool moved = false;

  double operator()(MotionSource source, MotionPart part) const {
    return of[static_cast<std::size_t>(source)][static_cast<std::size_t>(part)];
  }
};

/// What one step of the sliding graph has added, linearised at its estimates.
struct StepInformation {
  StateQuadratic range;    ///< on the later state
  LinkQuadratic imu;       ///< with the walks of biases and gravity
  LinkQuadratic velocity;  ///< with the walk of its calibration
  LinkQuadratic doppler;
};

/// Keeps the information on the newest state apart by where it comes from. The information H of a
/// least-squares problem is the covariance of the gradient's noise, and that is a sum over the
/// sources: H = sum of G_s. Elimination of a state is linear in the gradient, and so keeps the sum.
/// It changes no estimate.
class MotionLedger {
 public:
  /// A first state with this information.
  void start(const StateMatrix& information);

  /// The next state. None where the information does not determine the motion: all is forgotten
  /// until the next start.
  std::optional<MotionShares> add(const StepInformation& step, const NavState& from,
                                  const NavState& to);

 private:
  std::array<StateMatrix, kMotionSources> newest_{};  ///< by source; their sum is the information
  bool started_ = false;
};

}  // namespace adit
