// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "adit/slam/loops/loop_candidate.hpp"
#include "adit/slam/loops/loop_move.hpp"
#include "adit/slam/loops/loop_search.hpp"
#include "adit/slam/loops/loop_verification.hpp"
#include "adit/slam/loops/loop_voting.hpp"
#include "adit/slam/loops/map_aliases.hpp"
#include "adit/slam/loops/place_index.hpp"
#include "adit/slam/loops/search_pauses.hpp"
#include "adit/slam/submaps/map_memory.hpp"
#include "adit/slam/submaps/submap_cache.hpp"

namespace adit {

/// What has become of the loops of a run.
struct LoopReport {
  std::size_t candidates = 0;
  std::size_t by_appearance = 0;                    ///< among the candidates
  std::size_t without_vertical = 0;                 ///< keyframes that are not known by their looks
  std::size_t accepted = 0;                         ///< and not taken back
  std::size_t accepted_by_appearance = 0;           ///< among the accepted
  std::array<std::size_t, kLoopReasons> refused{};  ///< by LoopReason; those taken back, too
  std::size_t optimizations = 0;
  /// The accepted loop that is farthest from where the odometry alone has it, in its standard
  /// deviations; known at the run's end.
  std::optional<LoopMove> farthest_from_odometry{};
  /// Squared, a degree of freedom, mean over the accepted loops: what the map leaves of them at the
  /// run's end.
  double residual_squared = 0.0;
  double largest_correction = 0.0;  ///< m, that an optimisation moved the newest keyframe by
  std::vector<float> search_ms;     ///< host time per keyframe, with its waits for the device
};

/// What alignments of submaps are expected to leave (rms, m) after those of consecutive ones.
double usual_rms(std::vector<double> consecutive);

/// A candidate on its way to a verdict.
struct PendingLoop {
  LoopHypothesis loop;
  LoopCandidate record;
  bool expected = true;  ///< it is where the graph had it
  // Once it has been accepted:
  std::size_t votes = 0;
  std::optional<DriftDifference> shown{};  ///< of the odometry's drift
  std::size_t together = 1;                ///< loops that were accepted with it
  bool tried_again = false;                ///< it was taken back once
};

/// A keyframe of an earlier session, which may be seen again.
struct EarlierPlace {
  bool levelled = false;                        ///< its vertical is known
  std::optional<PlaceDescriptor> descriptor{};  ///< none: it is not found by appearance
};

/// How a keyframe looks at a place of the map of earlier sessions.
struct PlaceLikeness {
  enum class Kind { not_mapped, alike, different };
  Kind kind = Kind::not_mapped;
  std::optional<double> through{};  ///< share of the points that one sees through in the other
};

/// Finds loops, verifies them, and lets those in that agree (docs/theory/loops.md).
class LoopCloser {
 public:
  /// `context` must outlive it. `load` reads the submaps of earlier keyframes. No loops are looked
  /// for once the graph has outgrown `memory`.
  LoopCloser(engine::Context& context, const Config& config, SubmapLoader load,
             const MapMemory& memory);

  /// The graph begins with nodes of earlier sessions, which `places` are of, in its order; where
  /// these look alike, `aliases` know; `last_id` is the highest of the store's candidates. Only
  /// before all else.
  void begin_behind(std::span<const EarlierPlace> places, MapAliases aliases, int64_t last_id);
  /// The session would be tied to the earlier ones, if it could not be at another place as well.
  bool is_ambiguous() const { return ambiguous_; }
  /// Natural logarithm of the best odds of a place of the session so far against the likeliest
  /// alternative; nothing: no bundle of loops agreed on a place.
  std::optional<double> best_log_odds() const { return best_log_odds_; }

  /// Rms distance (m) in an alignment of consecutive submaps, against which those of loops are
  /// held.
  void add_expected_rms(double rms) { rms_.push_back(rms); }

  /// What the next node's submap looks like; nothing where its vertical is not known. To be called
  /// once for each node, in their order, and before find().
  std::optional<PlaceDescriptor> describe(const KeyframeSubmap& submap, const SurfaceCloud& cloud);

  /// Verified and refused candidates of the graph's newest node, whose submap is `submap` and, on
  /// the device, `cloud`. To be called once for each node, in their order.
  std::vector<PendingLoop> find(const PoseGraph& graph, const KeyframeSubmap& submap,
                                const SurfaceCloud& cloud);

  /// From now on loops are looked for between two maps alone. The graph has all nodes of the later
  /// map from the start: `first` and those after it, with their edges to each other. `same_site`:
  /// the maps are known to be of one site, so that only places that they have compete. To be called
  /// after begin_behind().
  void search_between(NodeId first, bool same_site = false);
  /// Where the later map looks like itself, with the poses that the graph has now: another place
  /// for it is one where it would be shifted by that.
  void set_own_aliases(MapAliases aliases) { own_aliases_ = std::move(aliases); }
  /// What find_between() needs to know of a node: to be called once for each node of the later map,
  /// in their order.
  void note(const KeyframeSubmap& submap);
  /// As find(), of a node of the later map that was noted. The one that was described last is found
  /// by appearance, too, all others by position alone.
  std::vector<PendingLoop> find_between(const PoseGraph& graph, NodeId node,
                                        const KeyframeSubmap& submap, const SurfaceCloud& cloud);

  /// What a step has changed.
  struct Change {
    std::vector<LoopCandidate> records;                        ///< for the store
    std::vector<PoseEdge> edges;                               ///< that the graph has got
    std::vector<std::pair<std::size_t, EdgeStatus>> statuses;  ///< new ones of the graph's edges
    bool moved = false;                                        ///< the graph has other poses
  };
  /// What was found for `keyframe` takes effect: it joins the queue, whose loops vote; the graph
  /// gets those that are accepted, and is optimised where they do not fit it, or enough have come
  /// in.
  Change take_effect(PoseGraph& graph, NodeId keyframe, std::vector<PendingLoop> found);
  /// Verdicts about what is still waiting.
  Change finish(PoseGraph& graph);

  /// Whether the later map, which loops have tied, is where they have it: by all of its keyframes
  /// that the earlier map has the place of, and against all places that look the same. If another
  /// place is nearly as likely, or the maps are of places that are built alike, the loops are taken
  /// back. After search_between() and finish().
  Change confirm_join(PoseGraph& graph);
  /// Natural logarithm of the odds, as of the last confirm_join(), that the places which the maps
  /// have in common are the same, against that they are built alike: equal walls with other things
  /// between them. Nothing where that is known otherwise: one site, or places in the world.
  std::optional<double> built_alike_log_odds() const { return built_alike_log_odds_; }
  /// They are rather built alike.
  bool is_built_alike() const { return built_alike_log_odds_ && *built_alike_log_odds_ < 0.0; }

  const LoopReport& report() const { return report_; }

 private:
  std::vector<PendingLoop> verified(std::span<const LoopPlace> places, NodeId newest,
                                    const KeyframeSubmap& submap, const SurfaceCloud& cloud);
  PendingLoop judged(const LoopPlace& place, NodeId newest, const LoopVerification& verdict);
  void note_gap(const PoseGraph& graph, const KeyframeSubmap& submap);
  void sort_by_parts(const PoseGraph& graph);
  void leave(const PoseGraph& graph, std::deque<PendingLoop>& queue,
             std::span<const LoopVote> votes, Change& change);
  void review_joins(PoseGraph& graph, Change& change);
  void undo_join(PoseGraph& graph, const TrackingGap& gap, double figure, Change& change);
  void settle(PoseGraph& graph, NodeId oldest, Change& change);
  std::vector<LoopVote> voted(const PoseGraph& graph, const std::deque<PendingLoop>& queue,
                              bool last_chance) const;
  bool is_apart_from_map(std::span<const std::optional<RelativePlace>> known) const;
  std::vector<PendingLoop> found_of(const PoseGraph& graph, NodeId node,
                                    const KeyframeSubmap& submap, const SurfaceCloud& cloud,
                                    bool is_described);
  std::vector<LoopPlace> predicted_places(const PoseGraph& graph, NodeId of) const;
  std::vector<std::size_t> nodes_beside(const PoseGraph& graph,
                                        const Eigen::Isometry3d& T_map_place) const;
  std::vector<std::size_t> asked_nodes(const PoseGraph& graph, NodeId node, std::size_t most) const;
  std::vector<std::size_t> confirming_nodes(const PoseGraph& graph, NodeId tied) const;
  PlaceLikeness likeness_at(const PoseGraph& graph, std::size_t node,
                            const Eigen::Isometry3d& T_map_node);
  PlaceLikeness compared(const PoseGraph& graph, std::size_t node,
                         const Eigen::Isometry3d& T_map_node);
  static Eigen::Isometry3d map_from_part(const PoseGraph& graph, const LoopHypothesis& loop);
  std::vector<Eigen::Isometry3d> competing_hypotheses(const PoseGraph& graph,
                                                      const LoopHypothesis& loop) const;
  void add_hypothesis(const PoseGraph& graph, const LoopHypothesis& loop, std::size_t to,
                      std::vector<Eigen::Isometry3d>& known) const;
  double least_log_odds(const PoseGraph& graph, const Eigen::Isometry3d& T_map_part,
                        std::span<const std::size_t> asked,
                        std::span<const Eigen::Isometry3d> hypotheses);
  double expected_log_odds(const PoseGraph& graph, std::span<const std::size_t> asked);
  bool refuse_ambiguous_joins(const PoseGraph& graph, std::vector<LoopVote>& votes, Change& change);
  bool let_in(PoseGraph& graph, std::deque<PendingLoop>& queue, std::span<const LoopVote> votes,
              Change& change);
  bool may_wait(const PoseGraph& graph, std::span<const int64_t> let_in);
  void optimize_and_review(PoseGraph& graph, std::vector<int64_t> let_in, Change& change);
  bool review(PoseGraph& graph, std::span<const int64_t> let_in, Change& change);
  bool let_in_again(PoseGraph& graph, std::vector<int64_t>& let_in, Change& change);
  void note_correction(const PoseGraph& graph, std::span<const Eigen::Isometry3d> poses);
  void accept(PendingLoop pending, std::size_t votes);
  void forget_revoked();
  void refuse(PendingLoop& pending, LoopReason reason, double figure, Change& change);
  void take_back(PendingLoop& accepted, LoopReason reason, double figure, Change& change);

  engine::Context* context_;
  MapMemory memory_;
  SubmapCache submaps_;
  PlaceIndex index_;
  LoopSearchSettings search_;
  AppearanceSearchSettings appearance_;
  AppearanceSearchSettings searching_;  ///< of a session that nothing ties to the map yet
  LoopVotingSettings voting_;
  LoopVerifier verifier_;
  std::vector<double> reaches_;  ///< m, in the order of the graph's nodes
  std::vector<bool> levelled_;   ///< they know their vertical, in the same order
  std::vector<double> rms_;      ///< m, of alignments of consecutive submaps
  std::vector<TrackingGap> gaps_;
  std::vector<double> speeds_;       ///< m/s, from keyframe to keyframe
  Nanoseconds last_stamp_{0};        ///< the newest keyframe's
  Nanoseconds last_tracked_{0};      ///< when the odometry was last on its track
  std::deque<PendingLoop> queue_;    ///< in the order of their later keyframes
  std::deque<PendingLoop> joining_;  ///< the same, of those that tie parts of the graph
  std::vector<PendingLoop> accepted_;
  std::size_t waiting_ = 0;              ///< loops that came in since the graph was optimised
  std::vector<PendingLoop> doubted_;     ///< that a review has taken back
  std::deque<LoopHypothesis> opposing_;  ///< the latest that were refused behind gaps
  std::vector<LoopHypothesis> refuted_;  ///< the latest claims of drift that is not possible
  MapAliases aliases_;                   ///< of the map of earlier sessions
  MapAliases own_aliases_;               ///< of the later map, in its own frame
  bool same_site_ = false;               ///< as of search_between()
  bool ambiguous_ = false;
  std::optional<double> best_log_odds_;
  std::optional<double> built_alike_log_odds_;
  /// By keyframe and the place (m, map) that it was held to; asked again with each later one.
  std::map<std::tuple<NodeId, int64_t, int64_t, int64_t>, PlaceLikeness> likeness_;
  SearchPauses pauses_;  ///< of the search by appearance
  int64_t next_id_ = 1;
  int64_t reviewed_ = 0;  ///< the opposing loop up to which joins have been reviewed
  LoopReport report_;
};

}  // namespace adit
