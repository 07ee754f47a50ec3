// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// The store of a session that is localised in a map: it sees the map's keyframes and its own, and
/// what it stores goes into a file of its own. The map stays as it is. Loops between the two, which
/// neither file can hold without the other, are forgotten at the end; the session's keyframes have
/// the poses that these have led to.
class SessionOverMap final : public MapStore {
 public:
  /// Both must outlive it; `own` is new. It gets the map's place in the world.
  SessionOverMap(const MapDatabase& map, MapDatabase& own);

  SessionId add_session(const MapSession& session) override { return own_->add_session(session); }
  void store(const KeyframeRecord& record) override;
  void revise(const MapRevision& revision) override;
  void begin_end(Nanoseconds last_sweep) override { own_->begin_end(last_sweep); }

  std::vector<MapSession> sessions() const override { return own_->sessions(); }
  std::vector<MapKeyframe> keyframes() const override;
  /// Without the loops between the two.
  PoseGraph graph() const override;
  std::vector<LoopCandidate> candidates() const override;
  std::vector<MapFix> fixes() const override;
  std::vector<MapHeading> headings() const override;
  std::optional<Georeference> georeference() const override { return map_->georeference(); }
  MapSubmap submap(NodeId keyframe) const override { return of(keyframe).submap(keyframe); }
  std::vector<std::byte> chunk(NodeId keyframe, std::size_t number) const override {
    return of(keyframe).chunk(keyframe, number);
  }
  std::vector<NodeId> submaps_within(const Eigen::Vector3d& lower,
                                     const Eigen::Vector3d& upper) const override;

 private:
  bool is_own(NodeId keyframe) const { return keyframe >= first_own_; }
  const MapDatabase& of(NodeId keyframe) const { return is_own(keyframe) ? *own_ : *map_; }
  bool is_between_own(NodeId from, NodeId to) const { return is_own(from) && is_own(to); }
  std::vector<PoseEdge> take_edges(const std::vector<PoseEdge>& edges);

  const MapDatabase* map_;
  MapDatabase* own_;
  NodeId first_own_ = 0;
  std::size_t map_edges_ = 0;
  /// By edge of the session: its number among those of `own`; none: it leads to the map.
  std::vector<std::optional<std::size_t>> own_edges_;
  std::size_t stored_edges_ = 0;  ///< in `own`
};

}  // namespace adit
