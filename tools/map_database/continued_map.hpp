// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// The store of a run that does again what an earlier one has begun (docs/decisions/0022): steps
/// that the earlier run has stored are compared instead of stored, and from where it stopped on the
/// map grows. Until then the map stays as it is, also where the run ends before.
class ContinuedMap final : public MapStore {
 public:
  /// `map` must outlive it; `session` is the earlier run's.
  ContinuedMap(MapDatabase& map, SessionId session);

  /// Throws std::logic_error: the session is there.
  SessionId add_session(const MapSession& session) override;
  /// Throws InputError where it is not what the earlier run has stored.
  void store(const KeyframeRecord& record) override;
  void revise(const MapRevision& revision) override;
  void begin_end(Nanoseconds last_sweep) override;

  /// The run has come to where the earlier one stopped.
  bool caught_up() const { return replayed_ == stored_; }
  int64_t stored_steps() const { return stored_; }

  std::vector<MapSession> sessions() const override { return map_->sessions(); }
  std::vector<MapKeyframe> keyframes() const override { return map_->keyframes(); }
  PoseGraph graph() const override { return map_->graph(); }
  std::vector<LoopCandidate> candidates() const override { return map_->candidates(); }
  std::vector<MapFix> fixes() const override { return map_->fixes(); }
  std::vector<MapHeading> headings() const override { return map_->headings(); }
  std::optional<Georeference> georeference() const override { return map_->georeference(); }
  MapSubmap submap(NodeId keyframe) const override { return map_->submap(keyframe); }
  std::vector<std::byte> chunk(NodeId keyframe, std::size_t number) const override {
    return map_->chunk(keyframe, number);
  }
  std::vector<NodeId> submaps_within(const Eigen::Vector3d& lower,
                                     const Eigen::Vector3d& upper) const override {
    return map_->submaps_within(lower, upper);
  }

 private:
  bool skips();
  bool is_stored(const KeyframeRecord& record) const;

  MapDatabase* map_;
  SessionId session_;
  int64_t stored_;
  int64_t replayed_ = 0;
  /// The last sweep that the earlier run's end has stored, where it came to an end.
  std::optional<Nanoseconds> last_stored_;
  bool stays_ = false;  ///< whatever comes, the map stays as it is
};

}  // namespace adit
