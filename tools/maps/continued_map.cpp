// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/maps/continued_map.hpp"

#include <optional>
#include <stdexcept>
#include <string>

namespace adit {

ContinuedMap::ContinuedMap(MapDatabase& map, SessionId session)
    : map_(&map), session_(session), stored_(map.progress(session).steps) {
  map.begin_run(session);
}

SessionId ContinuedMap::add_session(const MapSession& session) {
  throw std::logic_error("a continued map has its session: " + session.name);
}

// True for a step that is stored, and for all steps of a run that has not come beyond those.
bool ContinuedMap::skips() {
  if (stopped_early_) {
    return true;
  }
  if (!caught_up()) {
    ++replayed_;
    return true;
  }
  if (!begun_) {
    map_->take_end_back(session_);
    begun_ = true;
  }
  return false;
}

void ContinuedMap::store(const KeyframeRecord& record) {
  if (!skips()) {
    map_->store(record);
  } else if (!stopped_early_) {
    compare(record);
  }
}

void ContinuedMap::revise(const MapRevision& revision) {
  if (!skips()) {
    map_->revise(revision);
  }
}

void ContinuedMap::begin_end() {
  stopped_early_ = stopped_early_ || !caught_up();
  if (!stopped_early_) {
    if (!begun_) {
      map_->take_end_back(session_);
      begun_ = true;
    }
    map_->begin_end();
  }
}

// Poses apart, which loops and the end of a run may have changed: they follow from these.
void ContinuedMap::compare(const KeyframeRecord& record) const {
  const MapKeyframe& made = record.keyframe;
  const std::optional<MapKeyframe> stored = map_->keyframe(made.id);
  const auto differs = [&](const MapSubmap& submap) {
    return submap.lower != record.submap.lower || submap.upper != record.submap.upper ||
           submap.chunks != record.submap.chunks;
  };
  if (!stored || stored->stamp != made.stamp || stored->covariance != made.covariance ||
      differs(map_->submap(made.id))) {
    throw InputError(
        map_->file(), Place::named("keyframe " + std::to_string(made.id)),
        "it is not what this run makes of the recording",
        "The map stays as it was. Recording, settings, device and version of adit must "
        "be those of the run that began it; map anew into another folder");
  }
}

}  // namespace adit
