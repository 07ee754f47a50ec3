// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/map_aliases.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include "adit/slam/loops/loop_reason.hpp"

namespace adit {
namespace {

// Of the same displacement, measured at two places: as far as an alignment of submaps of a corridor
// may slide, and what its error of the turn comes to on the way between the places.
constexpr double kSame = 1.0;           // m
constexpr double kSameTurn = 0.1;       // rad
constexpr double kSameOnTheWay = 0.02;  // m a metre
// Less is drift, or an alignment that slid.
constexpr double kLeastMove = 2.0;  // m
constexpr double kLeastTurn = 0.5;  // rad
constexpr std::size_t kLeastPlaces = 3;
constexpr std::size_t kMost = 8;
constexpr std::size_t kLeastAccepted = 10;  // loops, for their mean to count

bool is_alike_elsewhere(const LoopCandidate& candidate) {
  constexpr std::array kContradicted = {LoopReason::against_odometry, LoopReason::against_loops,
                                        LoopReason::another_place};
  return std::ranges::any_of(
      kContradicted, [&](LoopReason reason) { return candidate.reason == to_string(reason); });
}

ThroughShares through_shares(std::span<const LoopCandidate> candidates) {
  double sum = 0.0;
  std::size_t accepted = 0;
  for (const LoopCandidate& candidate : candidates) {
    if (candidate.verdict == CandidateVerdict::accepted && candidate.source != LoopSource::hand) {
      sum += candidate.through;
      ++accepted;
    }
  }
  ThroughShares shares;
  if (accepted >= kLeastAccepted) {
    const double right = std::max(sum / static_cast<double>(accepted), shares.right);
    shares.alike *= right / shares.right;
    shares.right = right;
  }
  return shares;
}

double log_density(double through, double mean) {
  return -through / mean - std::log(mean);
}

}  // namespace

double MapAlias::mean_through() const {
  double sum = 0.0;
  for (const Measured& one : measured_) {
    sum += one.through;
  }
  return sum / static_cast<double>(measured_.size());
}

const MapAlias::Measured& MapAlias::nearest(const Eigen::Vector3d& at) const {
  return *std::ranges::min_element(
      measured_, {}, [&](const Measured& one) { return (one.at - at).squaredNorm(); });
}

Eigen::Isometry3d MapAlias::moved(const Eigen::Isometry3d& T_map_place) const {
  return nearest(T_map_place.translation()).T_alias_place * T_map_place;
}

bool MapAlias::agrees(const Measured& other) const {
  const Measured& known = nearest(other.at);
  const double apart = (known.T_alias_place * other.at - other.T_alias_place * other.at).norm();
  return apart <= kSame + kSameOnTheWay * (known.at - other.at).norm() &&
         rotation_angle(known.T_alias_place.linear().transpose() * other.T_alias_place.linear()) <=
             kSameTurn;
}

MapAliases map_aliases(const PoseGraph& graph, std::span<const LoopCandidate> candidates) {
  std::vector<MapAlias> aliases;
  for (const LoopCandidate& candidate : candidates) {
    if (!is_alike_elsewhere(candidate) || !graph.contains(candidate.from) ||
        !graph.contains(candidate.to)) {
      continue;
    }
    const Eigen::Isometry3d& T_map_to = graph.nodes()[graph.index_of(candidate.to)].T_map_node;
    const Eigen::Isometry3d T_map_alike =
        graph.nodes()[graph.index_of(candidate.from)].T_map_node * candidate.T_from_to;
    const Eigen::Isometry3d T_alias_place = T_map_alike * T_map_to.inverse();
    const std::array both = {
        MapAlias::Measured{T_map_to.translation(), T_alias_place, candidate.through},
        MapAlias::Measured{T_map_alike.translation(), T_alias_place.inverse(), candidate.through}};
    if ((T_map_alike.translation() - T_map_to.translation()).norm() < kLeastMove &&
        rotation_angle(T_alias_place.linear()) < kLeastTurn) {
      continue;
    }
    for (const MapAlias::Measured& one : both) {
      auto same =
          std::ranges::find_if(aliases, [&](const MapAlias& alias) { return alias.agrees(one); });
      if (same == aliases.end()) {
        same = aliases.emplace(aliases.end());
      }
      same->add(one);
    }
  }
  std::erase_if(aliases, [](const MapAlias& alias) { return alias.places() < kLeastPlaces; });
  std::ranges::stable_sort(aliases, std::greater<>(), &MapAlias::places);
  aliases.resize(std::min(aliases.size(), kMost));
  return {.all = std::move(aliases), .through = through_shares(candidates)};
}

double log_ratio_to_built_alike(std::span<const double> through, const ThroughShares& shares) {
  constexpr int kSteps = 200;
  double right = 0.0;
  for (const double one : through) {
    right += log_density(one, shares.right);
  }
  std::array<double, kSteps> sums{};  // of the log likelihood of being built alike
  for (std::size_t step = 0; step < sums.size(); ++step) {
    const double equal = (static_cast<double>(step) + 0.5) / kSteps;
    for (const double one : through) {
      sums[step] += std::log(equal * std::exp(log_density(one, shares.right)) +
                             (1.0 - equal) * std::exp(log_density(one, shares.alike)));
    }
  }
  const double highest = std::ranges::max(sums);
  double mean = 0.0;
  for (const double sum : sums) {
    mean += std::exp(sum - highest) / kSteps;
  }
  return right - highest - std::log(mean);
}

}  // namespace adit
