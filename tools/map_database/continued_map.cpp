// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/continued_map.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "adit/tools/map_database/map_trajectory.hpp"

namespace adit {

ContinuedMap::ContinuedMap(MapDatabase& map, SessionId session)
    : map_(&map), session_(session), stored_(map.progress(session).steps) {
  if (map.progress(session).ending) {
    const std::vector<MapKeyframe> keyframes = map.keyframes();
    if (!keyframes.empty()) {
      last_stored_ = load_sweeps(map, keyframes.back().id, map.file()).sweeps.back().stamp;
    }
  }
  map.begin_run(session_);
  map.take_end_back();
}

SessionId ContinuedMap::add_session(const MapSession& session) {
  throw std::logic_error("a continued map has its session: " + session.name);
}

// True for a step that is stored, and for all steps of a run that has not come beyond those.
bool ContinuedMap::skips() {
  if (!stays_ && !caught_up()) {
    ++replayed_;
    return true;
  }
  return stays_;
}

void ContinuedMap::store(const KeyframeRecord& record) {
  const bool compares = !stays_ && !caught_up();
  if (!skips()) {
    map_->store(record);
  } else if (compares && !is_stored(record)) {
    stays_ = true;
    throw InputError(
        map_->file(), Place::named("keyframe " + std::to_string(record.keyframe.id)),
        "it is not what this run makes of the recording",
        "The map stays as it was. Recording, settings, device and version of adit must "
        "be those of the run that began it; map anew into another folder");
  }
}

void ContinuedMap::revise(const MapRevision& revision) {
  if (!skips()) {
    map_->revise(revision);
  }
}

// A run that ends before it has come as far as the earlier one leaves that one's map.
void ContinuedMap::begin_end(Nanoseconds last_sweep) {
  stays_ = stays_ || !caught_up() || (last_stored_ && last_sweep < *last_stored_);
  if (!stays_) {
    map_->begin_end(last_sweep);
  }
}

// Poses apart, which loops and the end of a run may have changed: they follow from these.
bool ContinuedMap::is_stored(const KeyframeRecord& record) const {
  const MapKeyframe& made = record.keyframe;
  const std::optional<MapKeyframe> stored = map_->keyframe(made.id);
  if (!stored || stored->stamp != made.stamp || stored->covariance != made.covariance) {
    return false;
  }
  const MapSubmap submap = map_->submap(made.id);
  return submap.lower == record.submap.lower && submap.upper == record.submap.upper &&
         submap.chunks == record.submap.chunks;
}

}  // namespace adit
