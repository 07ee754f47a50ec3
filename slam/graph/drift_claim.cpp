// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/drift_claim.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

namespace adit {
namespace {

// Two stretches are followed backwards as long as each keyframe of the later one has one of the
// earlier so near, m, at most so many before the last that had.
constexpr double kSamePlace = 2.5;
constexpr std::size_t kNeighbours = 3;

// Loops over shorter ways show little, m; and together they have to show as much as one over so
// many.
constexpr double kLeastWay = 10.0;
constexpr double kShown = 50.0;
// What a climb may differ by from the one that has been shown: m, m a metre, and so many times what
// that scatters by, as a share of it, within limits.
constexpr double kClimbAside = 0.5;
constexpr double kClimbChange = 0.01;
constexpr double kClimbScatters = 3.0;
constexpr double kLeastClimbShare = 0.1;
constexpr double kMostClimbShare = 0.5;
// It is steady where it scatters by no more than this share.
constexpr double kSteadyClimb = 0.25;

// Claims that grow are off a line from nothing by less than this share of what claims of their size
// that stay the same would be.
constexpr double kGrowingClaims = 0.25;

struct Way {
  Eigen::Isometry3d T_start_end = Eigen::Isometry3d::Identity();  ///< as its edges measured it
  double length = std::numeric_limits<double>::infinity();        ///< m; infinite: there is none
  double uncorrected = 0.0;  ///< m that no loop has corrected, from the far end to the start
};

/// The shortest way between two nodes along active edges. `corrected` as within_loops().
Way shortest_way(const PoseGraph& graph, const std::vector<bool>& corrected, std::size_t start,
                 std::size_t end) {
  std::vector<Way> ways(graph.nodes().size());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  ways[start].length = 0.0;
  open.emplace(0.0, start);
  while (!open.empty()) {
    const auto [way, at] = open.top();
    open.pop();
    if (at == end) {
      break;
    }
    if (way > ways[at].length) {
      continue;
    }
    const NodeId id = graph.nodes()[at].id;
    for (const std::size_t index : graph.edges_of(id)) {
      const PoseEdge& edge = graph.edges()[index];
      const std::size_t next = graph.index_of(edge.from == id ? edge.to : edge.from);
      const double length = edge.T_from_to.translation().norm();
      if (edge.status == EdgeStatus::active && way + length < ways[next].length) {
        const bool counts = edge.kind == EdgeKind::odometry && !corrected[std::min(at, next)];
        ways[next] = {.T_start_end = ways[at].T_start_end *
                                     (edge.from == id ? edge.T_from_to : edge.T_from_to.inverse()),
                      .length = way + length,
                      .uncorrected = ways[at].uncorrected + (!counts     ? 0.0
                                                             : next < at ? length
                                                                         : -length)};
        open.emplace(way + length, next);
      }
    }
  }
  return ways[end];
}

/// The active odometry edge to a node from the one before it; null: there is none.
const PoseEdge* edge_before(const PoseGraph& graph, std::size_t at) {
  for (const std::size_t index : graph.edges_of(graph.nodes()[at].id)) {
    const PoseEdge& edge = graph.edges()[index];
    if (edge.kind == EdgeKind::odometry && edge.status == EdgeStatus::active &&
        graph.index_of(edge.to) == at && graph.index_of(edge.from) + 1 == at) {
      return &edge;
    }
  }
  return nullptr;
}

double angle_about_z(const Eigen::Matrix3d& rotation) {
  return std::abs(std::atan2(rotation(1, 0), rotation(0, 0)));
}

}  // namespace

bool is_possible_drift(const Eigen::Isometry3d& error, double path, const DriftLimits& limits,
                       bool levelled) {
  const double turn = levelled ? angle_about_z(error.linear()) : rotation_angle(error.linear());
  const Eigen::Vector3d& off = error.translation();
  if (!levelled) {
    return turn <= limits.least_turn + limits.turn * path &&
           off.norm() <=
               limits.least_distance + (std::max(limits.aside, limits.height) + turn) * path;
  }
  // A turn on the way moves what comes after it aside.
  return turn <= limits.least_turn + limits.turn * path &&
         off.head<2>().norm() <= limits.least_distance + (limits.aside + turn) * path &&
         std::abs(off.z()) <= limits.least_distance + limits.height * path;
}

bool is_tilted(const Eigen::Isometry3d& T_from_to, const DriftLimits& limits) {
  return std::acos(std::clamp(T_from_to.linear()(2, 2), -1.0, 1.0)) > limits.tilt;
}

bool drift_explains(const PoseGraph& graph, NodeId from, NodeId to,
                    const Eigen::Isometry3d& T_from_to, const DriftLimits& limits, bool levelled) {
  std::size_t earlier = graph.index_of(from);
  std::size_t later = graph.index_of(to);
  if (levelled && is_tilted(T_from_to, limits)) {
    return false;
  }
  const std::vector<bool> corrected(graph.nodes().size());
  Way way = shortest_way(graph, corrected, earlier, later);
  if (std::isinf(way.length)) {
    return true;
  }
  Eigen::Isometry3d T_claimed = T_from_to;  // from the earlier place of the pair to the later one
  const auto is_possible = [&] {
    return is_possible_drift(way.T_start_end * T_claimed.inverse(), way.length, limits, levelled);
  };
  if (!is_possible()) {
    return false;
  }
  while (later > 0) {
    const PoseEdge* const back = edge_before(graph, later);
    if (back == nullptr) {
      return true;
    }
    --later;
    T_claimed = T_claimed * back->T_from_to.inverse();
    // The earlier stretch's keyframe where this one of the later stretch is claimed to be.
    std::optional<std::size_t> same;
    Eigen::Isometry3d T_same_claimed = T_claimed;
    double nearest = kSamePlace;
    Eigen::Isometry3d T_i_claimed = T_claimed;
    for (std::size_t i = earlier, steps = 0;; --i, ++steps) {
      const double apart = T_i_claimed.translation().norm();
      if (i < later && apart < nearest) {
        nearest = apart;
        same = i;
        T_same_claimed = T_i_claimed;
      }
      const PoseEdge* const edge = i > 0 && steps < kNeighbours ? edge_before(graph, i) : nullptr;
      if (edge == nullptr) {
        break;
      }
      T_i_claimed = edge->T_from_to * T_i_claimed;
    }
    if (!same) {
      return true;  // the stretches part here
    }
    earlier = *same;
    T_claimed = T_same_claimed;
    way = shortest_way(graph, corrected, earlier, later);
    if (way.length <= kSamePlace) {
      return true;  // loops that were accepted tie them from here on backwards
    }
    if (!is_possible()) {
      return false;
    }
  }
  return true;
}

std::vector<bool> within_loops(const PoseGraph& graph) {
  std::vector<int> changes(graph.nodes().size() + 1);
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active) {
      const auto [first, last] = std::minmax({graph.index_of(edge.from), graph.index_of(edge.to)});
      ++changes[first];
      --changes[last];
    }
  }
  std::vector<bool> result(graph.nodes().size());
  int open = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    open += changes[i];
    result[i] = open > 0;
  }
  return result;
}

ClaimedClimb claimed_climb(const PoseGraph& graph, NodeId from, NodeId to,
                           const Eigen::Isometry3d& T_from_to) {
  const std::size_t earlier = graph.index_of(from);
  const std::size_t later = graph.index_of(to);
  const Way way = shortest_way(graph, within_loops(graph), later, earlier);
  const Eigen::Isometry3d believed =
      graph.nodes()[earlier].T_map_node.inverse() * graph.nodes()[later].T_map_node;
  return {.climb = (believed * T_from_to.inverse()).translation().z(),
          .length = way.length,
          .way = way.uncorrected};
}

std::optional<ClaimedClimb> climb_of_odometry(const PoseGraph& graph, NodeId from, NodeId to,
                                              const Eigen::Isometry3d& T_from_to) {
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  double length = 0.0;
  for (std::size_t at = graph.index_of(from) + 1; at <= graph.index_of(to); ++at) {
    const PoseEdge* edge = edge_before(graph, at);
    if (edge == nullptr) {
      return std::nullopt;
    }
    moved = moved * edge->T_from_to;
    length += edge->T_from_to.translation().norm();
  }
  return ClaimedClimb{
      .climb = (moved * T_from_to.inverse()).translation().z(), .length = length, .way = length};
}

ClaimedDrift claimed_drift(const PoseGraph& graph, NodeId from, NodeId to,
                           const Eigen::Isometry3d& T_from_to) {
  const std::size_t earlier = graph.index_of(from);
  const std::size_t later = graph.index_of(to);
  const std::vector<bool> corrected(graph.nodes().size());
  return {.off = graph.nodes()[later].T_map_node.translation() -
                 graph.nodes()[earlier].T_map_node * T_from_to.translation(),
          .way = shortest_way(graph, corrected, later, earlier).length};
}

bool grows_with_way(std::span<const ClaimedDrift> claims) {
  double ways = 0.0;
  double squared_ways = 0.0;
  double squared_claims = 0.0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d products = Eigen::Vector3d::Zero();
  for (const ClaimedDrift& claim : claims) {
    if (!std::isfinite(claim.way)) {
      return false;
    }
    ways += claim.way;
    squared_ways += claim.way * claim.way;
    squared_claims += claim.off.squaredNorm();
    sum += claim.off;
    products += claim.way * claim.off;
  }
  if (!(squared_ways > 0.0)) {
    return false;
  }
  // Sums of squares off the best line from nothing, of these and of what stays the same.
  const auto count = static_cast<double>(claims.size());
  const double off = squared_claims - products.squaredNorm() / squared_ways;
  const double staying = sum.squaredNorm() / count * (1.0 - ways * ways / (count * squared_ways));
  return off <= kGrowingClaims * kGrowingClaims * staying;
}

void ShownClimb::add(const ClaimedClimb& accepted) {
  if (std::isfinite(accepted.length) && std::abs(accepted.way) >= kLeastWay) {
    squared_way_ += accepted.way * accepted.way;
    way_climb_ += accepted.way * accepted.climb;
    squared_climb_ += accepted.climb * accepted.climb;
  }
}

double ShownClimb::rate() const {
  return squared_way_ > 0.0 ? way_climb_ / squared_way_ : 0.0;
}

double ShownClimb::scatter() const {
  const double shown = rate() * way_climb_;  // m², of squared_climb_
  return shown > 0.0 ? std::sqrt(std::max(0.0, squared_climb_ / shown - 1.0))
                     : std::numeric_limits<double>::infinity();
}

bool ShownClimb::allows(const ClaimedClimb& claim) const {
  if (squared_way_ < kShown * kShown || !std::isfinite(claim.length)) {
    return true;
  }
  const double share = std::clamp(kClimbScatters * scatter(), kLeastClimbShare, kMostClimbShare);
  const auto aside = [&](double way) {
    return kClimbAside + std::max(kClimbChange, share * std::abs(rate())) * std::abs(way);
  };
  const double corrected = rate() * claim.way;
  const double whole = rate() * claim.length;
  return claim.climb >= std::min(corrected - aside(claim.way), whole - aside(claim.length)) &&
         claim.climb <= std::max(corrected + aside(claim.way), whole + aside(claim.length));
}

bool ShownClimb::is_steady() const {
  return squared_way_ >= kShown * kShown && std::abs(rate()) > kClimbChange &&
         scatter() <= kSteadyClimb;
}

}  // namespace adit
