// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/search_places.hpp"

#include <array>
#include <numbers>

namespace adit {
namespace {

constexpr int kHeadings = 8;
constexpr std::array<std::array<double, 2>, 4> kAside = {
    {{2.0, 0.0}, {-2.0, 0.0}, {0.0, 2.0}, {0.0, -2.0}}};  // m, the lidar's x and y
// The search finds its way from about half as far as these are apart.
constexpr std::array kTurns = {-0.7, -0.35, 0.35, 0.7};  // rad
static_assert(kHeadings + kAside.size() + 1 == kMostPlaces);
static_assert(2 * kTurns.size() + 4 <= kMostPlaces);

/// About the map's z, on the spot.
Eigen::Isometry3d turned(Eigen::Isometry3d pose, double heading) {
  pose.linear() = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) * pose.linear();
  return pose;
}

Eigen::Isometry3d middle(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return orthonormalized(a * se3_exp(0.5 * se3_log(a.inverse() * b)));
}

}  // namespace

std::vector<Eigen::Isometry3d> places_to_search(const Prediction& prediction,
                                                const std::optional<Silence>& silence) {
  if (prediction.trusted) {
    return {};
  }
  std::vector<Eigen::Isometry3d> places = {prediction.T_map_lidar};
  if (!prediction.lost && !silence) {
    return places;
  }
  for (int k = 1; k < kHeadings; ++k) {
    places.push_back(turned(prediction.T_map_lidar, 2.0 * std::numbers::pi * k / kHeadings));
  }
  for (const auto& [x, y] : kAside) {
    places.push_back(prediction.T_map_lidar * Eigen::Translation3d(x, y, 0.0));
  }
  places.push_back(silence ? silence->T_map_lidar : prediction.T_map_onward);
  return places;
}

std::vector<Eigen::Isometry3d> places_after_rejection(const PossibleMotions& motions) {
  std::vector<Eigen::Isometry3d> places = {motions.predicted, motions.steady, motions.at_rest,
                                           middle(motions.at_rest, motions.steady)};
  for (const double turn : kTurns) {
    places.push_back(turned(motions.at_rest, turn));
    places.push_back(turned(motions.steady, turn));
  }
  return places;
}

}  // namespace adit
