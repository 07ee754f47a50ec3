// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <ranges>

#include <Eigen/Eigenvalues>

#include "adit/slam/core/nav_state.hpp"

namespace adit {
namespace {

// The bounds separate lost runs from held ones on simulated places, sensors and ways,
// with and without an inertial sensor (docs/decisions/0016).
constexpr size_t kWindow = 10;      // sweeps that are looked at together for what is not held
constexpr size_t kLongWindow = 20;  // and for contradictions
constexpr size_t kApart = 20;       // sweeps between two stretches
// Without an inertial sensor this share of a window is too much; with one that carries, this.
constexpr double kUnheldShare = 0.5;
// Without an inertial sensor: what is held weakly, to no better than this, is not held.
constexpr double kVague = 0.05;  // m
constexpr double kUnheldShareInertial = 0.95;
constexpr double kMoved = 0.3;          // m in a window: what is at rest needs no match
constexpr double kMovedInertial = 1.0;  // m
// What inertia carried is not in doubt where all of it together is known to this share of the whole
// path, two sigma of which are 1 %.
constexpr double kCarriedShare = 0.005;
// A measured velocity that errs by less than this share of the speed from sweep to sweep leaves 1 %
// of the way after ten seconds of sweeps at 10 Hz, by its root.
constexpr double kMeasuredShare = 0.1;
constexpr double kLostAfter = 10.0;      // m along what neither matches nor inertia hold
constexpr double kContradiction = 10.0;  // median squared innovation per degree of freedom
constexpr size_t kLeaps = 2;             // in the long window: one may be a jolt
// A prediction alone is good for so long.
constexpr double kAlone = 1.0;          // s
constexpr double kAloneInertial = 2.0;  // s

bool is_unheld(const ObservedDirection& direction) {
  return direction.localizability == Localizability::none && !direction.axis.isZero();
}

bool is_vague(const ObservedDirection& direction, const Matrix6d& covariance) {
  const Eigen::Vector3d& axis = direction.axis;
  return direction.localizability == Localizability::partial && !axis.isZero() &&
         axis.dot(covariance.topLeftCorner<3, 3>() * axis) > kVague * kVague;
}

/// m, of the motion between them along the direction that is known least.
double largest_sigma(const UncertainPose& from, const UncertainPose& to) {
  const Eigen::Matrix3d way = motion_covariance(from, to).topLeftCorner<3, 3>();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(way).eigenvalues()[2]);
}

bool is_carried(const DoubtfulStretch& stretch) {
  return stretch.cause == DoubtCause::unheld && stretch.alone < kMoved;
}

/// Along the axis (lidar's, unit), by a sensor of velocities whose scale is known.
bool is_displacement_measured(const InertialReport& report, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d along = report.T_body_lidar.linear() * axis;
  return std::ranges::any_of(report.velocities, [&](const VelocityReport& velocity) {
    const double most = kMeasuredShare * velocity.innovation.predicted.norm();
    const bool scaled = velocity.source == VelocitySource::doppler ||
                        report.nav_covariance(kScaleAt, kScaleAt) < kCarriedShare * kCarriedShare;
    return velocity.fused() && scaled && along.dot(velocity.covariance * along) < most * most;
  });
}

}  // namespace

std::string_view to_string(Trust trust) {
  switch (trust) {
    case Trust::reliable:
      return "reliable";
    case Trust::doubtful:
      return "doubtful";
    case Trust::lost:
      return "lost";
  }
  return "unknown";
}

std::string_view to_string(DoubtCause cause) {
  switch (cause) {
    case DoubtCause::unheld:
      return "unheld";
    case DoubtCause::predicted:
      return "predicted";
    case DoubtCause::contradicted:
      return "contradicted";
    case DoubtCause::new_start:
      return "new start";
    case DoubtCause::silence:
      return "silence";
  }
  return "unknown";
}

Verdict with_loops(Verdict verdict, const MovedByLoops& moved) {
  if (moved.sigmas > kMostLoopSigmas) {
    verdict.trust = std::max(verdict.trust, Trust::doubtful);
    verdict.moved = moved;
  }
  return verdict;
}

UncertainPose RunAssessor::pose_of(const Seen& seen) {
  return {.stamp = seen.stamp, .T_map_lidar = seen.T_map_lidar, .uncertainty = seen.uncertainty};
}

void RunAssessor::add(const SweepResult& result) {
  Seen seen{
      .stamp = result.stamp, .T_map_lidar = result.T_map_lidar, .uncertainty = result.uncertainty};
  seen.aligned = result.state == OdometryState::tracking;
  seen.inertial = result.inertial.nav.has_value();
  seen.measured = result.displacement_measured;
  seen.leapt = result.leapt;
  const RegistrationResult& alignment = result.registration;
  if (seen.aligned) {
    // Turns are held by an inertial sensor itself.
    const bool vague =
        !seen.inertial && is_vague(alignment.translation[0], result.uncertainty.local);
    const bool slides =
        vague || (is_unheld(alignment.translation[0]) &&
                  !is_displacement_measured(result.inertial, alignment.translation[0].axis));
    seen.unheld = slides || (!seen.inertial && is_unheld(alignment.rotation[0]));
    if (slides) {
      seen.direction = result.T_map_lidar.linear() * alignment.translation[0].axis;
    }
  }
  const Innovation& innovation = result.inertial.innovation;
  seen.innovation = innovation.degrees > 0 ? innovation.nis / innovation.degrees : -1.0;
  if (!recent_.empty()) {
    const Seen& before = recent_.back();
    seen.step = (seen.T_map_lidar.translation() - before.T_map_lidar.translation()).norm();
    path_ += seen.step;
    alone_ = seen.aligned ? 0.0 : alone_ + seconds(seen.stamp - before.stamp);
  }
  if (result.rested) {
    forget_unheld();
  }
  ++count_;
  aligned_ += seen.aligned ? 1 : 0;
  const size_t bridged = since_aligned_;
  since_aligned_ = seen.aligned ? 0 : since_aligned_ + 1;
  recent_.push_back(seen);
  if (recent_.size() > kLongWindow) {
    recent_.pop_front();
  }
  if (result.state == OdometryState::restarted || result.renewed) {
    DoubtfulStretch& stretch = note(DoubtCause::new_start, since_aligned_);
    stretch.trust = result.renewed ? stretch.trust : Trust::lost;
    stretch.silence = result.silence;
    since_aligned_ = 0;
    alone_ = 0.0;
    return;
  }
  if (seen.aligned && result.silence > 0.0) {
    DoubtfulStretch& stretch = note(DoubtCause::silence, bridged + 2);  // from the last aligned one
    stretch.silence = std::max(stretch.silence, result.silence);
  }
  look_for_unheld();
  look_for_prediction();
  look_for_contradiction();
  look_for_leaps();
}

void RunAssessor::look_for_unheld() {
  if (recent_.size() < kWindow || !recent_.back().unheld) {
    return;
  }
  const auto window = std::ranges::subrange(recent_.end() - kWindow, recent_.end());
  double moved = 0.0;
  for (const Seen& seen : window) {
    moved += seen.step;
  }
  const bool inertial = std::ranges::all_of(window, &Seen::inertial);
  if (!inertial) {
    // Who seems to be at rest where nothing would show a motion may have set off.
    moved = std::max(moved, largest_sigma(pose_of(window.front()), pose_of(recent_.back())));
  }
  const auto unheld =
      std::ranges::count_if(window, [](const Seen& seen) { return seen.unheld || !seen.aligned; });
  const double share = static_cast<double>(unheld) / static_cast<double>(kWindow);
  // Who seems to stop where nothing would show a motion may be moving on.
  const bool goes_on = !inertial && !stretches_.empty() &&
                       stretches_.back().cause == DoubtCause::unheld &&
                       stretches_.back().last + 2 >= count_;
  if (share < (inertial ? kUnheldShareInertial : kUnheldShare) ||
      (!goes_on && moved < (inertial ? kMovedInertial : kMoved))) {
    return;
  }
  DoubtfulStretch& stretch = note(DoubtCause::unheld, kWindow);
  const Eigen::Vector3d& direction = recent_.back().direction;
  stretch.direction += stretch.direction.dot(direction) < 0.0 ? -direction : direction;
  if (stretch.alone > kLostAfter && !stretch.by_velocities()) {
    stretch.trust = Trust::lost;
  }
}

// What seemed to move along what no match held, or may have, was at rest: the readings held it.
void RunAssessor::forget_unheld() {
  for (size_t i = stretches_.size(); i-- > 0;) {
    if (stretches_[i].cause == DoubtCause::unheld) {
      stretches_.erase(stretches_.begin() + static_cast<std::ptrdiff_t>(i));
      begins_.erase(begins_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  for (Seen& seen : recent_) {
    seen.inertial = true;
  }
}

void RunAssessor::look_for_prediction() {
  const bool inertial = recent_.back().inertial;
  if (since_aligned_ > 0 && count_ > 1 && alone_ > (inertial ? kAloneInertial : kAlone)) {
    note(DoubtCause::predicted, std::min(since_aligned_, recent_.size()));
  }
}

void RunAssessor::look_for_contradiction() {
  std::vector<double> innovations;
  for (const Seen& seen : recent_) {
    if (seen.innovation >= 0.0) {
      innovations.push_back(seen.innovation);
    }
  }
  if (innovations.size() < kLongWindow) {
    return;
  }
  const auto middle = innovations.begin() + static_cast<std::ptrdiff_t>(kLongWindow / 2);
  std::ranges::nth_element(innovations, middle);
  if (*middle > kContradiction) {
    DoubtfulStretch& stretch = note(DoubtCause::contradicted, kLongWindow);
    stretch.innovation = std::max(stretch.innovation, *middle);
  }
}

void RunAssessor::look_for_leaps() {
  const auto leaps = static_cast<size_t>(std::ranges::count_if(recent_, &Seen::leapt));
  if (recent_.back().leapt && leaps >= kLeaps) {
    note(DoubtCause::contradicted, recent_.size());
  }
}

DoubtfulStretch& RunAssessor::note(DoubtCause cause, size_t sweeps) {
  sweeps = std::clamp(sweeps, size_t{1}, recent_.size());
  const size_t first = count_ - sweeps;
  const auto same =
      std::ranges::find(stretches_ | std::views::reverse, cause, &DoubtfulStretch::cause);
  DoubtfulStretch* stretch = nullptr;
  if (same != stretches_.rend() && same->last + kApart >= first && cause != DoubtCause::new_start) {
    stretch = &*same;
  } else {
    const Seen& begin = recent_[recent_.size() - sweeps];
    stretches_.push_back({.cause = cause, .first = first, .last = first, .begin = begin.stamp});
    begins_.push_back(pose_of(begin));
    stretch = &stretches_.back();
  }
  // What is new since it was noted last.
  const bool begins = stretch->last == stretch->first;
  for (size_t i = 0; i < recent_.size(); ++i) {
    const size_t index = count_ - recent_.size() + i;
    if (index > stretch->last || (begins && index == first)) {
      const double step = index > first ? recent_[i].step : 0.0;
      stretch->distance += step;
      stretch->alone += recent_[i].inertial ? 0.0 : step;
      stretch->fused += recent_[i].inertial ? 1U : 0U;
      stretch->measured += recent_[i].measured ? 1U : 0U;
    }
  }
  stretch->last = count_ - 1;
  stretch->end = recent_.back().stamp;
  const UncertainPose& begin = begins_[static_cast<size_t>(stretch - stretches_.data())];
  stretch->sigma = std::max(stretch->sigma, largest_sigma(begin, pose_of(recent_.back())));
  return *stretch;
}

Verdict RunAssessor::verdict() const {
  Verdict verdict{.trust = Trust::reliable, .stretches = stretches_};
  double carried = 0.0;  // m^2
  for (const DoubtfulStretch& stretch : stretches_) {
    carried += is_carried(stretch) ? stretch.sigma * stretch.sigma : 0.0;
  }
  if (std::sqrt(carried) < kCarriedShare * path_) {
    std::erase_if(verdict.stretches, is_carried);
  }
  for (DoubtfulStretch& stretch : verdict.stretches) {
    if (!stretch.direction.isZero()) {
      stretch.direction.normalize();
    }
    // What ends without having been found again, or was never aligned, is lost.
    if (stretch.cause == DoubtCause::predicted && stretch.last + 1 == count_) {
      stretch.trust = Trust::lost;
    }
    verdict.trust = std::max(verdict.trust, stretch.trust);
  }
  if (count_ > 1 && aligned_ == 0) {
    verdict.trust = Trust::lost;
  }
  return verdict;
}

}  // namespace adit
