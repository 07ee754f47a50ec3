// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/drift_claim.hpp"

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
  double length = std::numeric_limits<double>::infinity();  ///< m; infinite: there is none
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
        ways[next] = {.length = way + length,
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

/// m between a node and the one before it, by an active edge; infinite: there is none.
double step_before(const PoseGraph& graph, std::size_t at) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t index : graph.edges_of(graph.nodes()[at].id)) {
    const PoseEdge& edge = graph.edges()[index];
    const auto [first, last] = std::minmax({graph.index_of(edge.from), graph.index_of(edge.to)});
    if (edge.status == EdgeStatus::active && last == at && first + 1 == at) {
      least = std::min(least, edge.T_from_to.translation().norm());
    }
  }
  return least;
}

/// The way between two nodes that go backwards together. A step can shorten it by no more than both
/// have moved, so that it is looked for again only where what is left of the last one does not
/// tell: else a long parallel stretch would cost a search of the graph a keyframe.
class FollowedWay {
 public:
  FollowedWay(const PoseGraph& graph, std::size_t later, std::size_t earlier)
      : graph_(graph), corrected_(graph.nodes().size()), later_(later), earlier_(earlier) {
    measure();
  }

  double least() const { return least_; }  ///< m; before it has moved, its length

  void move_to(std::size_t later, std::size_t earlier) {
    constexpr double kRounding = 1e-9;  // m a step
    for (; later_ > later; --later_) {
      least_ -= step_before(graph_, later_) + kRounding;
    }
    for (; earlier_ > earlier; --earlier_) {
      least_ -= step_before(graph_, earlier_) + kRounding;
    }
    exact_ = false;
  }

  /// Whether `statement` holds for its length: one that holds for all longer ways as well.
  template <class Statement>
  bool holds(const Statement& statement) {
    if (statement(least_)) {
      return true;
    }
    if (exact_) {
      return false;
    }
    measure();
    return statement(least_);
  }

 private:
  void measure() {
    least_ = shortest_way(graph_, corrected_, later_, earlier_).length;
    exact_ = true;
  }

  const PoseGraph& graph_;
  std::vector<bool> corrected_;
  std::size_t later_;
  std::size_t earlier_;
  double least_ = 0.0;  ///< m, no way is shorter
  bool exact_ = false;  ///< it is the way's length
};

double angle_about_z(const Eigen::Matrix3d& rotation) {
  return std::abs(std::atan2(rotation(1, 0), rotation(0, 0)));
}

}  // namespace

bool is_possible_drift(const Eigen::Isometry3d& error, double path, const DriftLimits& limits) {
  const double turn = angle_about_z(error.linear());
  const Eigen::Vector3d& off = error.translation();
  // A turn on the way moves what comes after it aside.
  return turn <= limits.least_turn + limits.turn * path &&
         off.head<2>().norm() <= limits.least_distance + (limits.aside + turn) * path &&
         std::abs(off.z()) <= limits.least_distance + limits.height * path;
}

bool is_tilted(const Eigen::Isometry3d& T_from_to, const DriftLimits& limits) {
  return std::acos(std::clamp(T_from_to.linear()(2, 2), -1.0, 1.0)) > limits.tilt;
}

bool drift_explains(const PoseGraph& graph, NodeId from, NodeId to,
                    const Eigen::Isometry3d& T_from_to, const DriftLimits& limits) {
  const std::vector<PoseNode>& nodes = graph.nodes();
  std::size_t earlier = graph.index_of(from);
  std::size_t later = graph.index_of(to);
  if (is_tilted(T_from_to, limits)) {
    return false;
  }
  FollowedWay way(graph, later, earlier);
  if (std::isinf(way.least())) {
    return true;
  }
  const Eigen::Isometry3d T_claimed_map =
      nodes[earlier].T_map_node * T_from_to * nodes[later].T_map_node.inverse();
  // What was believed of the pair, against what is claimed.
  const auto is_possible = [&](double length) {
    const Eigen::Isometry3d error = T_claimed_map.inverse() * nodes[earlier].T_map_node;
    return is_possible_drift(nodes[earlier].T_map_node.inverse() * error, length, limits);
  };
  if (!way.holds(is_possible)) {
    return false;
  }
  while (later-- > 0) {
    // The earlier stretch's keyframe where this one of the later stretch is claimed to be.
    const Eigen::Isometry3d claimed = T_claimed_map * nodes[later].T_map_node;
    std::optional<std::size_t> same;
    double nearest = kSamePlace;
    const std::size_t first = earlier - std::min(earlier, kNeighbours);
    for (std::size_t i = first; i <= earlier && i < later; ++i) {
      const double apart = (nodes[i].T_map_node.translation() - claimed.translation()).norm();
      if (apart < nearest) {
        nearest = apart;
        same = i;
      }
    }
    if (!same) {
      return true;  // the stretches part here
    }
    earlier = *same;
    way.move_to(later, earlier);
    if (!way.holds([](double length) { return length > kSamePlace; })) {
      return true;  // loops that were accepted tie them from here on backwards
    }
    if (!way.holds(is_possible)) {
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
