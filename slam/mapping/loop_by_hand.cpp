// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/loop_by_hand.hpp"

#include <algorithm>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/slam/graph/relative_covariance.hpp"
#include "adit/slam/loops/loop_closer.hpp"
#include "adit/slam/mapping/start_place.hpp"
#include "adit/slam/submaps/submap_codec.hpp"

namespace adit {
namespace {

/// As the graph has it, as a loop search would ask.
LoopQuestion asked_of(const PoseGraph& graph, NodeId from, NodeId to) {
  const std::size_t at = graph.index_of(to);
  const RelativeCovariances covariances(graph);
  const auto known = LeastUncertainPaths(covariances, from).place(to);
  if (!known) {
    throw NoGuess("no edges lead from keyframe " + std::to_string(from) + " to " +
                  std::to_string(to));
  }
  const Eigen::Isometry3d& T_map_from = graph.nodes()[graph.index_of(from)].T_map_node;
  return {.T_from_to = T_map_from.inverse() * graph.nodes()[at].T_map_node,
          .covariance = known->covariance};
}

// The configuration may leave lengths to the first sweep; submaps have theirs.
Config with_lengths_of(Config config, const KeyframeSubmap& submap) {
  if (config.preprocess.r_input == 0.0) {
    config.preprocess.r_input = submap.r_submap;
  }
  return with_lengths(config, config.preprocess.r_input);
}

LoopVerification verified(engine::Context& context, LoopVerifier& verifier,
                          const KeyframeSubmap& from, const KeyframeSubmap& to,
                          LoopQuestion question, double rms) {
  question.from = &from;
  const SurfaceCloud cloud = make_surface_cloud(context, to);
  return verifier.verify(to, cloud, std::span(&question, 1), rms).front();
}

}  // namespace

double usual_rms(engine::Context& context, const Config& config, const MapStore& store) {
  constexpr std::size_t kAsked = 9;
  const PoseGraph graph = store.graph();
  std::vector<const PoseEdge*> ways;
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::odometry) {
      ways.push_back(&edge);
    }
  }
  std::vector<double> rms;
  std::optional<LoopVerifier> verifier;
  const std::size_t asked = std::min(ways.size(), kAsked);
  for (std::size_t i = 0; i < asked; ++i) {
    const PoseEdge& way = *ways[(2 * i + 1) * ways.size() / (2 * asked)];
    const LoopQuestion question{.T_from_to = way.T_from_to,
                                .covariance = symmetric_inverse(way.information)};
    const KeyframeSubmap from = decode(store.submap(way.from));
    if (!verifier) {
      verifier.emplace(context, with_lengths_of(config, from));
    }
    const LoopVerification found =
        verified(context, *verifier, from, decode(store.submap(way.to)), question, 0.0);
    if (found.reason == LoopReason::poor_fit) {  // it is aligned, and held against nothing
      rms.push_back(found.rms);
    }
  }
  return usual_rms(std::move(rms));
}

LoopVerification verify_by_hand(engine::Context& context, const Config& config,
                                const MapStore& store, const LoopByHand& loop, double usual) {
  LoopQuestion question = loop.guess ? LoopQuestion{.T_from_to = *loop.guess}
                                     : asked_of(store.graph(), loop.from, loop.to);
  // A person is no more certain than that, whatever the graph says.
  question.covariance =
      loop.guess ? covariance_of_guess() : Matrix6d(question.covariance + covariance_of_guess());
  const KeyframeSubmap from = decode(store.submap(loop.from));
  LoopVerifier verifier(context, with_lengths_of(config, from));
  return verified(context, verifier, from, decode(store.submap(loop.to)), question, usual);
}

}  // namespace adit
