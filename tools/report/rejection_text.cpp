// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/rejection_text.hpp"

#include <cmath>

#include "adit/slam/core/text.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {

std::string percent(double share) {
  return std::to_string(std::lround(100.0 * share)) + " %";
}

namespace {

std::string centimetres(double length) {
  return with_decimals(100.0 * length, 1);
}

struct RejectionText {
  std::string operator()(const PoseNotFinite&) const { return "the pose would not be finite"; }

  std::string operator()(const MovedTooFar& moved) const {
    return "it would have moved " + in_digits(moved.distance) + " m in " +
           in_digits(moved.elapsed) + " s (recovery.max_speed is " + in_digits(moved.max_speed) +
           " m/s)";
  }

  std::string operator()(const NotHeldAlong&) const {
    return "a search found a place that could as well be farther along: no match holds it there";
  }

  std::string operator()(const OverlapFallsShort& fit) const {
    return "a search found a place where " + percent(fit.overlap) +
           " of its points match the submap, of sweeps before " + percent(fit.usual) + " did";
  }

  std::string operator()(const ResidualTooLarge& fit) const {
    return "a search found a place where its points lie " + centimetres(fit.rms) +
           " cm from the submap's surfaces, those of sweeps before " + centimetres(fit.usual);
  }

  std::string operator()(const TwoPlaces& places) const {
    return "a search found two places, and where one matches 100 points the other matches " +
           std::to_string(std::lround(100.0 * places.competing_share));
  }

  std::string operator()(const BeyondMotion& moved) const {
    return "a search found a place " + with_decimals(moved.distance, 1) + " m and " +
           with_decimals(kDegreesPerRadian * moved.turn, 0) +
           " degrees away, which the sensor can hardly have reached in " +
           with_decimals(moved.seconds, 1) + " s";
  }

  std::string operator()(const BeyondReach& silence) const {
    return "no sweep was aligned for " + with_decimals(silence.seconds, 1) +
           " s: the sensor may have moved by " + with_decimals(silence.distance, 1) +
           " m, farther than the " + with_decimals(silence.reach, 1) + " m that its submap reaches";
  }

  std::string operator()(const NothingUsual&) const {
    return "too few sweeps before the silence show how well one fits";
  }
};

}  // namespace

std::string describe(const Rejection& rejection) {
  return std::visit(RejectionText{}, rejection);
}

}  // namespace adit
