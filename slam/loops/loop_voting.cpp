// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/loop_voting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "adit/slam/graph/relative_poses.hpp"

namespace adit {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

RelativePose measured(const LoopHypothesis& loop) {
  return {loop.T_from_to, loop.covariance};
}

double chi2(const RelativePose& error) {
  const Vector6d off = se3_log(error.pose);
  return off.dot(error.covariance.ldlt().solve(off));
}

/// With what an odometry drifts by on that path besides.
RelativePose drifting(RelativePose error, const OdometryDrift& drift) {
  error.covariance += error.response * drift.covariance() * error.response.transpose();
  return error;
}

ImpliedDrift claim_of(const LoopHypothesis& loop) {
  return {.from = loop.from,
          .to = loop.to,
          .T_from_to = loop.T_from_to,
          .covariance = loop.covariance,
          .levelled = loop.levelled};
}

double odometry_disagreement(RelativePoses& relative, const LoopHypothesis& loop) {
  const std::optional<RelativePose> known = relative.between(loop.to, loop.from);
  return known ? chi2(*known * measured(loop)) : kNever;
}

/// The cycle over both; nothing where the graph does not tie them.
std::optional<RelativePose> cycle(RelativePoses& relative, const LoopHypothesis& a,
                                  const LoopHypothesis& b) {
  const std::optional<RelativePose> later = relative.between(a.to, b.to);
  const std::optional<RelativePose> earlier = relative.between(b.from, a.from);
  return later && earlier ? std::optional(measured(a) * *later * inverse(measured(b)) * *earlier)
                          : std::nullopt;
}

/// A loop claims a height that the odometry is not believed to drift by, and fits it in all else: a
/// floor that is built like the one above or below. What drifts is off elsewhere, too.
bool is_another_floor(RelativePoses& measured_poses, const PoseGraph& graph,
                      const LoopHypothesis& loop, const OdometryDrift& drift,
                      const LoopVotingSettings& settings) {
  const std::optional<RelativePose> known = measured_poses.between(loop.to, loop.from);
  if (!known || !loop.levelled) {
    return false;
  }
  const DriftDifference claimed = *drift_difference(measured_poses, claim_of(loop));
  const Vector6d off = claimed.difference - claimed.response * drift.rates();
  const Eigen::Matrix3d R_map_to = graph.nodes()[graph.index_of(loop.to)].T_map_node.linear();
  const double climb = R_map_to.row(2).dot(off.head<3>());
  if (std::abs(climb) <= settings.another_floor + settings.another_floor_share * known->path) {
    return false;
  }
  Eigen::Matrix<double, 5, 6> but_height = Eigen::Matrix<double, 5, 6>::Zero();
  but_height.topLeftCorner<2, 3>() = R_map_to.topRows<2>();
  but_height.bottomRightCorner<3, 3>().setIdentity();
  const Eigen::Matrix<double, 5, 1> rest = but_height * off;
  const Eigen::Matrix<double, 5, 5> spread =
      but_height * claimed.covariance * but_height.transpose();
  return rest.dot(spread.ldlt().solve(rest)) <= settings.contradiction;
}

double disagreement(RelativePoses& relative, const LoopHypothesis& a, const LoopHypothesis& b) {
  const std::optional<RelativePose> error = cycle(relative, a, b);
  return error ? chi2(*error) : kNever;
}

/// What is known of the parts that a graph is in.
struct Parts {
  std::vector<std::size_t> part_of;  ///< by node
  std::span<const TrackingGap> gaps;
};

bool joins_parts(const PoseGraph& graph, const Parts& parts, const LoopHypothesis& loop) {
  return parts.part_of[graph.index_of(loop.from)] != parts.part_of[graph.index_of(loop.to)];
}

/// By how much a loop between parts claims that more way was gone in a gap than can have been: the
/// worst chi squared of the gaps between the two. Keyframes know which way is up, as only
/// appearance finds such loops. Infinite where it claims a height that no odometry is believed to
/// drift by, however little it knows it: a floor that is built like the one above or below.
double gap_disagreement(RelativePoses& relative, const PoseGraph& graph, const Parts& parts,
                        const LoopHypothesis& loop, const LoopVotingSettings& settings) {
  const std::size_t from_part = parts.part_of[graph.index_of(loop.from)];
  const std::size_t to_part = parts.part_of[graph.index_of(loop.to)];
  double worst = 0.0;
  for (const GapCrossing& gap :
       gap_crossings(graph, parts.part_of, parts.gaps, from_part, to_part)) {
    const bool forward = parts.part_of[graph.index_of(gap.last)] == from_part;
    const auto before = relative.between(gap.last, forward ? loop.from : loop.to);
    const auto after = relative.between(forward ? loop.to : loop.from, gap.first);
    if (!before || !after) {
      continue;
    }
    const RelativePose crossed =
        *before * (forward ? measured(loop) : inverse(measured(loop))) * *after;
    const Eigen::Vector3d gone = crossed.pose.translation();
    const double aside = gone.head<2>().norm();
    const double climbed = gone.z() - gap.rise;
    Eigen::Vector3d beyond = Eigen::Vector3d::Zero();
    beyond.head<2>() = gone.head<2>() * (std::max(0.0, aside - gap.reach) / std::max(aside, 1e-9));
    beyond.z() = std::copysign(std::max(0.0, std::abs(climbed) - gap.climb), climbed);
    if (std::abs(beyond.z()) >
        settings.another_floor + settings.another_floor_share * (crossed.path + gap.between)) {
      return kNever;
    }
    const Eigen::Matrix3d R = crossed.pose.linear();
    const Eigen::Matrix3d spread =
        R * crossed.covariance.topLeftCorner<3, 3>() * R.transpose() +
        settings.gap_sigma * settings.gap_sigma * Eigen::Matrix3d::Identity();
    worst = std::max(worst, beyond.dot(spread.ldlt().solve(beyond)));
  }
  return worst;
}

/// Hypotheses that agree with one of them, with each other, and belong to different keyframes.
struct Bundle {
  std::vector<std::size_t> members;
  double cost = 0.0;
};

bool better(const Bundle& a, const Bundle& b) {
  return std::tuple(b.members.size(), a.cost) < std::tuple(a.members.size(), b.cost);
}

/// Disagreement of all loops with all.
using Table = std::vector<std::vector<double>>;

// The seed's best partner of each other keyframe, best first, as far as they agree with all before.
Bundle bundle_of(std::size_t seed, std::span<const LoopHypothesis> all, const Table& table,
                 const std::vector<bool>& open, double agreement) {
  std::map<NodeId, std::size_t> partners;
  for (std::size_t m = 0; m < all.size(); ++m) {
    if (!open[m] || all[m].to == all[seed].to || table[seed][m] > agreement) {
      continue;
    }
    const auto [place, is_new] = partners.emplace(all[m].to, m);
    if (!is_new && table[seed][m] < table[seed][place->second]) {
      place->second = m;
    }
  }
  std::vector<std::size_t> order;
  for (const auto& [node, m] : partners) {
    order.push_back(m);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t m) { return table[seed][m]; });
  Bundle bundle{.members = {seed}};
  for (const std::size_t m : order) {
    if (std::ranges::all_of(bundle.members,
                            [&](std::size_t k) { return table[k][m] <= agreement; })) {
      bundle.members.push_back(m);
      bundle.cost += table[seed][m];
    }
  }
  return bundle;
}

/// The worst disagreement with an accepted loop, where too many of them contradict, by what was
/// measured and by what the graph has made of it; else nothing. What is unexpected is held against
/// what drift may have done on the cycle's paths.
std::optional<double> contradicted(RelativePoses& far_poses, RelativePoses& measured_poses,
                                   const LoopHypothesis& loop, bool unexpected,
                                   const EarlierLoops& before, const LoopVotingSettings& settings) {
  const std::span<const LoopHypothesis> accepted = before.accepted;
  const auto asked = accepted.last(std::min(accepted.size(), settings.most_asked));
  std::size_t speaking = 0;
  std::size_t contradicting = 0;
  double worst = 0.0;
  for (const LoopHypothesis& other : asked) {
    const std::optional<RelativePose> error = cycle(far_poses, loop, other);
    if (!error) {
      continue;  // loops of other parts of the map say nothing
    }
    ++speaking;
    const auto contradicts = [&](const RelativePose& one) {
      return unexpected ? before.drift.excess({.difference = se3_log(one.pose),
                                               .covariance = one.covariance,
                                               .response = one.response,
                                               .levelled = loop.levelled && other.levelled}) > 1.0
                        : chi2(one) > settings.contradiction;
    };
    if (contradicts(*error) && contradicts(*cycle(measured_poses, loop, other))) {
      ++contradicting;
      worst = std::max(worst, chi2(*error));
    }
  }
  const double most = settings.most_contradicting * static_cast<double>(speaking);
  return static_cast<double>(contradicting) > most ? std::optional(worst) : std::nullopt;
}

/// What all votes rest on.
struct Poll {
  std::span<const LoopHypothesis> all;
  std::vector<bool> open;  ///< nothing speaks against it
  Table table;             ///< disagreements
};

/// How the two keyframes are turned to each other, whatever else the graph knows of them.
bool knows_heading(RelativePoses& relative, const LoopHypothesis& loop,
                   const LoopVotingSettings& settings) {
  const std::optional<RelativePose> known = relative.between(loop.from, loop.to);
  return known && std::sqrt(known->covariance(5, 5)) <= settings.heading_sigma;
}

/// m^3 of the box around all keyframes, at least a storey high.
double explored_volume(const PoseGraph& graph) {
  constexpr double kStorey = 3.0;  // m
  Eigen::AlignedBox3d box;
  for (const PoseNode& node : graph.nodes()) {
    box.extend(node.T_map_node.translation());
  }
  return box.sizes().cwiseMax(kStorey).prod();
}

/// The graph has the later keyframe where its session is expected to begin.
bool is_by_expectation(const PoseGraph& graph, const LoopHypothesis& loop,
                       std::size_t earlier_nodes) {
  return graph.index_of(loop.from) < earlier_nodes && graph.index_of(loop.to) >= earlier_nodes &&
         expects_start(graph);
}

/// Whether the odometry and the loops before object.
LoopVote first_judged(RelativePoses& far_poses, RelativePoses& measured_poses,
                      const PoseGraph& graph, const Parts& parts, const LoopHypothesis& loop,
                      const EarlierLoops& before, const LoopVotingSettings& settings) {
  const bool joins = joins_parts(graph, parts, loop);
  LoopVote vote{.odometry_chi2 = joins ? gap_disagreement(far_poses, graph, parts, loop, settings)
                                       : odometry_disagreement(far_poses, loop)};
  vote.blind = !joins && loop.without_heading && !knows_heading(far_poses, loop, settings);
  const std::optional<DriftDifference> difference =
      drift_difference(measured_poses, claim_of(loop));
  const auto is_explained = [&] {
    return joins ? vote.odometry_chi2 <= settings.gap && !is_tilted(loop.T_from_to)
                 : drift_explains(graph, measured_poses, claim_of(loop), before.drift) &&
                       (!difference || before.drift.log_odds(*difference, explored_volume(graph)) >=
                                           settings.least_log_odds);
  };
  // Drift that has been shown may have brought another place to where this one was.
  const auto is_plausible = [&] { return !difference || before.drift.excess(*difference) <= 1.0; };
  const auto claims_the_same = [&](const LoopHypothesis& other) {
    return disagreement(far_poses, loop, other) <= settings.agreement;
  };
  vote.unexpected = joins || !(vote.odometry_chi2 <= settings.contradiction);
  // What somebody expects is off in height as in all else, and its covariance says by how much.
  const bool may_climb = joins || is_by_expectation(graph, loop, before.earlier_nodes);
  const bool is_possible =
      (may_climb || !is_another_floor(measured_poses, graph, loop, before.drift, settings)) &&
      (vote.unexpected ? is_explained() && std::ranges::none_of(before.refuted, claims_the_same)
                       : is_plausible());
  if (!is_possible) {
    vote.objection = LoopObjection::odometry;
    return vote;
  }
  if (const auto worst =
          contradicted(far_poses, measured_poses, loop, vote.unexpected, before, settings)) {
    vote.objection = LoopObjection::loops;
    vote.worst_chi2 = *worst;
  }
  return vote;
}

/// The largest bundle of those of one kind.
std::optional<Bundle> best_bundle(const Poll& poll, std::vector<LoopVote>& votes, bool unexpected,
                                  double agreement) {
  std::vector<bool> open = poll.open;
  for (std::size_t k = 0; k < open.size(); ++k) {
    open[k] = open[k] && votes[k].unexpected == unexpected;
  }
  std::optional<Bundle> best;
  for (std::size_t k = 0; k < open.size(); ++k) {
    if (open[k]) {
      const Bundle bundle = bundle_of(k, poll.all, poll.table, open, agreement);
      votes[k].voters = bundle.members.size();
      best = !best || better(bundle, *best) ? bundle : *best;
    }
  }
  return best;
}

/// A crossing has one or two keyframes: what is strong and undisputed may come alone.
std::optional<Bundle> single_crossing(const Poll& poll, const std::vector<LoopVote>& votes,
                                      std::size_t most_voters, double contradiction) {
  const auto alone = [&](std::size_t k) {
    return poll.open[k] && !votes[k].unexpected && !votes[k].blind && poll.all[k].strong &&
           poll.all[k].to == poll.all.front().to && votes[k].voters == most_voters;
  };
  const auto disputed = [&](std::size_t k) {
    for (std::size_t m = 0; m < poll.all.size(); ++m) {
      if (poll.open[m] && !votes[m].unexpected && m != k && poll.table[k][m] > contradiction) {
        return true;
      }
    }
    return false;
  };
  std::optional<std::size_t> one;
  for (std::size_t k = 0; k < poll.all.size(); ++k) {
    if (alone(k) && !disputed(k) && (!one || votes[k].odometry_chi2 < votes[*one].odometry_chi2)) {
      one = k;
    }
  }
  if (!one) {
    return std::nullopt;
  }
  Bundle bundle;
  bundle.members.push_back(*one);
  return bundle;
}

/// Whether later keyframes of a bundle lie far enough apart, or look elsewhere, to tie parts.
bool is_wide(const PoseGraph& graph, const Poll& poll, const Bundle& bundle,
             const LoopVotingSettings& settings) {
  const auto pose = [&](std::size_t k) {
    return graph.nodes()[graph.index_of(poll.all[k].to)].T_map_node;
  };
  return std::ranges::any_of(bundle.members, [&](std::size_t a) {
    return std::ranges::any_of(bundle.members, [&](std::size_t b) {
      const Eigen::Isometry3d way = pose(a).inverse() * pose(b);
      return way.translation().norm() >= settings.least_apart ||
             rotation_angle(way.linear()) >= settings.least_turned;
    });
  });
}

/// Whether later keyframes of a bundle do not lie on one line: seen along the line, a place may be
/// like itself turned by half.
bool is_broad(const PoseGraph& graph, const Poll& poll, const Bundle& bundle,
              const LoopVotingSettings& settings) {
  std::vector<Eigen::Vector2d> places;
  for (const std::size_t k : bundle.members) {
    places.emplace_back(
        graph.nodes()[graph.index_of(poll.all[k].to)].T_map_node.translation().head<2>());
  }
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& a : places) {
    for (const Eigen::Vector2d& b : places) {
      along = (b - a).norm() > along.norm() ? Eigen::Vector2d(b - a) : along;
    }
  }
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  double lowest = kNever;
  double highest = -kNever;
  for (const Eigen::Vector2d& place : places) {
    lowest = std::min(lowest, across.dot(place));
    highest = std::max(highest, across.dot(place));
  }
  return highest - lowest >= settings.least_aside;
}

/// The bundle that the odometry does not bear out, where it is large enough and nothing speaks
/// against it; those that another bundle disputes are told so.
std::optional<Bundle> unexpected_bundle(const PoseGraph& graph, const Parts& parts,
                                        const Poll& poll, std::vector<LoopVote>& votes,
                                        std::size_t earlier_nodes,
                                        const LoopVotingSettings& settings) {
  std::optional<Bundle> best = best_bundle(poll, votes, true, settings.agreement);
  if (!best || best->members.size() < settings.least_unexpected ||
      (joins_parts(graph, parts, poll.all[best->members.front()]) &&
       !is_wide(graph, poll, *best, settings))) {
    return std::nullopt;
  }
  const LoopHypothesis& one = poll.all[best->members.front()];
  if (joins_parts(graph, parts, one) && graph.index_of(one.from) < earlier_nodes) {
    return best;
  }
  for (std::size_t m = 0; m < poll.all.size(); ++m) {
    const bool counts = !votes[m].unexpected || 2 * votes[m].voters > best->members.size();
    const bool against = std::ranges::any_of(best->members, [&](std::size_t k) {
      // What nothing ties together says nothing.
      return k != m && poll.table[k][m] > settings.contradiction && poll.table[k][m] < kNever;
    });
    if (poll.open[m] && counts && against) {
      for (const std::size_t k : best->members) {
        votes[k].objection = LoopObjection::places;
      }
      return std::nullopt;
    }
  }
  return best;
}

}  // namespace

double disagreement(const PoseGraph& graph, const LoopHypothesis& a, const LoopHypothesis& b) {
  const RelativeCovariances covariances(graph);
  RelativePoses relative(graph, covariances, Poses::measured);
  return disagreement(relative, a, b);
}

double odometry_disagreement(const PoseGraph& graph, const LoopHypothesis& loop) {
  const RelativeCovariances covariances(graph);
  RelativePoses relative(graph, covariances, Poses::optimized);
  return odometry_disagreement(relative, loop);
}

std::optional<DriftDifference> shown_drift(const PoseGraph& graph, const LoopHypothesis& loop,
                                           const LoopVotingSettings& settings) {
  const RelativeCovariances covariances(graph);
  RelativePoses relative(graph, covariances, Poses::measured, settings.lumps);
  return drift_difference(relative, claim_of(loop));
}

std::vector<LoopVote> vote(const PoseGraph& graph, std::span<const LoopHypothesis> hypotheses,
                           const EarlierLoops& before, bool last_chance,
                           const LoopVotingSettings& settings) {
  const RelativeCovariances covariances(graph);
  RelativePoses relative(graph, covariances, Poses::measured);  // between neighbours
  RelativePoses far_poses(graph, covariances, Poses::optimized, settings.lumps);  // whole rounds
  RelativePoses measured_poses(graph, covariances, Poses::measured, settings.lumps);
  const Parts parts{.part_of = connected_components(graph).component_of, .gaps = before.gaps};
  std::vector<LoopVote> votes;
  Poll poll{.all = hypotheses, .open = {}, .table = Table(hypotheses.size())};
  for (const LoopHypothesis& loop : hypotheses) {
    votes.push_back(first_judged(far_poses, measured_poses, graph, parts, loop, before, settings));
    poll.open.push_back(votes.back().objection == LoopObjection::voters);
  }
  for (std::size_t a = 0; a < hypotheses.size(); ++a) {
    poll.table[a].resize(hypotheses.size(), 0.0);
    for (std::size_t b = 0; b < a; ++b) {
      if (poll.open[a] && poll.open[b]) {
        const auto error = cycle(relative, hypotheses[b], hypotheses[a]);
        const bool drifted = votes[a].unexpected || votes[b].unexpected;
        poll.table[a][b] = poll.table[b][a] =
            !error ? kNever : chi2(drifted ? drifting(*error, before.drift) : *error);
      }
    }
  }
  std::optional<Bundle> best = best_bundle(poll, votes, false, settings.agreement);
  if (best && best->members.size() < settings.least_voters) {
    best = last_chance ? single_crossing(poll, votes, best->members.size(), settings.contradiction)
                       : std::nullopt;
  }
  const auto may_be_turned = [&](const Bundle& bundle) {
    return std::ranges::any_of(bundle.members, [&](std::size_t k) { return votes[k].blind; }) &&
           !is_broad(graph, poll, bundle, settings);
  };
  if (best && may_be_turned(*best)) {
    best.reset();
  }
  if (!best) {
    best = unexpected_bundle(graph, parts, poll, votes, before.earlier_nodes, settings);
    if (best && may_be_turned(*best)) {
      best.reset();
    }
  }
  const Bundle chosen = best.value_or(Bundle());
  for (const std::size_t k : chosen.members) {
    votes[k].accepted = true;
    votes[k].objection = LoopObjection::none;
    for (const std::size_t m : chosen.members) {
      votes[k].worst_chi2 = std::max(votes[k].worst_chi2, poll.table[k][m]);
    }
  }
  return votes;
}

}  // namespace adit
