// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/loop_voting.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include <Eigen/Cholesky>

#include "adit/slam/mapping/relative_covariance.hpp"

namespace adit {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A pose with the covariance of its right perturbation.
struct Uncertain {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();
};

Uncertain operator*(const Uncertain& a, const Uncertain& b) {
  return {a.pose * b.pose, compounded(a.covariance, b.pose, b.covariance)};
}

Uncertain inverse(const Uncertain& a) {
  return {a.pose.inverse(), inverted(a.pose, a.covariance)};
}

Uncertain measured(const LoopHypothesis& loop) {
  return {loop.T_from_to, loop.covariance};
}

double chi2(const Uncertain& error) {
  const Vector6d off = se3_log(error.pose);
  return off.dot(error.covariance.ldlt().solve(off));
}

/// Relative poses that the graph knows, each node's asked for once.
class Ways {
 public:
  explicit Ways(const PoseGraph& graph, double lumps = 1.0) : graph_(graph), lumps_(lumps) {}

  std::optional<Uncertain> between(NodeId from, NodeId to) {
    auto known = known_.find(from);
    if (known == known_.end()) {
      known = known_.emplace(from, relative_places(graph_, from, lumps_)).first;
    }
    const std::size_t index = graph_.index_of(to);
    const std::optional<RelativePlace>& place = known->second[index];
    if (!place) {
      return std::nullopt;
    }
    return Uncertain{graph_.nodes()[graph_.index_of(from)].T_map_node.inverse() *
                         graph_.nodes()[index].T_map_node,
                     place->covariance};
  }

 private:
  const PoseGraph& graph_;
  double lumps_;
  std::map<NodeId, std::vector<std::optional<RelativePlace>>> known_;
};

double odometry_disagreement(Ways& ways, const LoopHypothesis& loop) {
  const std::optional<Uncertain> known = ways.between(loop.to, loop.from);
  return known ? chi2(*known * measured(loop)) : kNever;
}

double disagreement(Ways& ways, const LoopHypothesis& a, const LoopHypothesis& b) {
  const std::optional<Uncertain> later = ways.between(a.to, b.to);
  const std::optional<Uncertain> earlier = ways.between(b.from, a.from);
  return later && earlier ? chi2(measured(a) * *later * inverse(measured(b)) * *earlier) : kNever;
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

/// The worst disagreement with an accepted loop, where too many of them contradict; else nothing.
std::optional<double> contradicted(Ways& ways, const LoopHypothesis& loop,
                                   std::span<const LoopHypothesis> accepted,
                                   const LoopVotingSettings& settings) {
  const auto asked = accepted.last(std::min(accepted.size(), settings.most_asked));
  std::size_t contradicting = 0;
  double worst = 0.0;
  for (const LoopHypothesis& other : asked) {
    const double value = disagreement(ways, loop, other);
    // Loops of other parts of the map say nothing.
    if (value != kNever && value > settings.contradiction) {
      ++contradicting;
      worst = std::max(worst, value);
    }
  }
  const double most = settings.most_contradicting * static_cast<double>(asked.size());
  return static_cast<double>(contradicting) > most ? std::optional(worst) : std::nullopt;
}

}  // namespace

double disagreement(const PoseGraph& graph, const LoopHypothesis& a, const LoopHypothesis& b) {
  Ways ways(graph);
  return disagreement(ways, a, b);
}

double odometry_disagreement(const PoseGraph& graph, const LoopHypothesis& loop) {
  Ways ways(graph);
  return odometry_disagreement(ways, loop);
}

std::vector<LoopVote> vote(const PoseGraph& graph, std::span<const LoopHypothesis> hypotheses,
                           std::span<const LoopHypothesis> accepted, bool last_chance,
                           const LoopVotingSettings& settings) {
  Ways ways(graph);                      // short ones, between neighbours
  Ways far_ways(graph, settings.lumps);  // long ones, whole rounds
  std::vector<LoopVote> votes(hypotheses.size());
  std::vector<bool> open(hypotheses.size(), true);
  for (std::size_t k = 0; k < hypotheses.size(); ++k) {
    votes[k].odometry_chi2 = odometry_disagreement(far_ways, hypotheses[k]);
    if (!(votes[k].odometry_chi2 <= settings.contradiction)) {
      votes[k].objection = LoopObjection::odometry;
      open[k] = false;
    } else if (const auto worst = contradicted(far_ways, hypotheses[k], accepted, settings)) {
      votes[k].objection = LoopObjection::loops;
      votes[k].worst_chi2 = *worst;
      open[k] = false;
    }
  }
  Table table(hypotheses.size(), std::vector<double>(hypotheses.size(), 0.0));
  for (std::size_t a = 0; a < hypotheses.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (open[a] && open[b]) {
        table[a][b] = table[b][a] = disagreement(ways, hypotheses[b], hypotheses[a]);
      }
    }
  }
  std::optional<Bundle> best;
  for (std::size_t k = 0; k < hypotheses.size(); ++k) {
    if (!open[k]) {
      continue;
    }
    const Bundle bundle = bundle_of(k, hypotheses, table, open, settings.agreement);
    votes[k].voters = bundle.members.size();
    best = !best || better(bundle, *best) ? bundle : *best;
  }
  if (best && best->members.size() < settings.least_voters) {
    // A crossing has one or two keyframes: what is strong and undisputed may come alone.
    const auto alone = [&](std::size_t k) {
      return open[k] && last_chance && hypotheses[k].strong &&
             hypotheses[k].to == hypotheses.front().to && votes[k].voters == best->members.size();
    };
    const auto disputed = [&](std::size_t k) {
      for (std::size_t m = 0; m < hypotheses.size(); ++m) {
        if (open[m] && m != k && table[k][m] > settings.contradiction) {
          return true;
        }
      }
      return false;
    };
    std::optional<std::size_t> one;
    for (std::size_t k = 0; k < hypotheses.size(); ++k) {
      if (alone(k) && !disputed(k) &&
          (!one || votes[k].odometry_chi2 < votes[*one].odometry_chi2)) {
        one = k;
      }
    }
    best = one ? std::optional(Bundle{.members = {*one}}) : std::nullopt;
  }
  for (const std::size_t k : best ? best->members : std::vector<std::size_t>()) {
    votes[k].accepted = true;
    votes[k].objection = LoopObjection::none;
    for (const std::size_t m : best->members) {
      votes[k].worst_chi2 = std::max(votes[k].worst_chi2, table[k][m]);
    }
  }
  return votes;
}

}  // namespace adit
