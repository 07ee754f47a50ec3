// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Anchors: where the frame of each session lies in the map's. Poses of keyframes are stored in the
// frame of their session and come out in the map's.
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_records.hpp"

namespace adit {
namespace {

bool moves(const Eigen::Isometry3d& anchor) {
  return anchor.matrix() != Eigen::Matrix4d::Identity();
}

}  // namespace

// A map of an older schema may lack the table.
Anchors MapDatabase::anchors() const {
  Anchors anchors;
  SqliteStatement table =
      database_.prepare("SELECT count(*) FROM sqlite_schema WHERE name = 'anchors'");
  if (!table.step() || table.integer(0) == 0) {
    return anchors;
  }
  SqliteStatement rows = database_.prepare("SELECT session, pose FROM anchors");
  while (rows.step()) {
    const SessionId session = rows.integer(0);
    const Eigen::Isometry3d pose =
        pose_from(numbers<12>(rows.blob(1), database_.path(), "the anchor of session", session));
    if (moves(pose)) {
      anchors.emplace(session, pose);
    }
  }
  return anchors;
}

void MapDatabase::set_anchor(SessionId session, const Eigen::Isometry3d& T_map_session) {
  SqliteTransaction transaction(database_);
  database_.prepare("INSERT OR REPLACE INTO anchors(session, pose) VALUES(?, ?)")
      .bind(1, session)
      .bind(2, as_bytes(pose_numbers(T_map_session)))
      .step();
  for (const MapKeyframe& keyframe : keyframes()) {
    if (keyframe.session == session) {
      place(keyframe.id, keyframe.T_map_keyframe);
    }
  }
  database_.execute("UPDATE sessions SET edited = 1");
  transaction.commit();
}

MapKeyframe in_map(MapKeyframe keyframe, const Anchors& anchors) {
  const auto anchor = anchors.find(keyframe.session);
  if (anchor != anchors.end()) {
    keyframe.T_map_keyframe = anchor->second * keyframe.T_map_keyframe;
  }
  return keyframe;
}

Eigen::Isometry3d in_session(SessionId session, const Eigen::Isometry3d& T_map_keyframe,
                             const Anchors& anchors) {
  const auto anchor = anchors.find(session);
  return anchor == anchors.end() ? T_map_keyframe : anchor->second.inverse() * T_map_keyframe;
}

}  // namespace adit
