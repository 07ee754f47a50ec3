// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a map knows of the run that fills it: how far it has come, and what its end has changed.
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_records.hpp"

namespace adit {
namespace {

constexpr const char* kRememberAll =
    "DELETE FROM end_keyframes; DELETE FROM end_edges; DELETE FROM end_candidates;"
    "DELETE FROM end_fixes; DELETE FROM end_georeference;"
    "INSERT INTO end_fixes(id, verdict, chi2, information, antenna)"
    " SELECT id, verdict, chi2, information, antenna FROM fixes;"
    "INSERT INTO end_georeference SELECT * FROM georeference;"
    "INSERT INTO end_keyframes(id, fixed, pose) SELECT id, fixed, pose FROM keyframes;"
    "INSERT INTO end_edges(id, status) SELECT id, status FROM edges;"
    "INSERT INTO end_candidates(id, node_from, node_to, verdict, pose, score, overlap, chi2, "
    "reason,"
    " rms, correction, turn, through, figure, source)"
    " SELECT id, node_from, node_to, verdict, pose, score, overlap, chi2, reason, rms, correction,"
    " turn, through, figure, source FROM candidates;";

constexpr const char* kTakeBack =
    "DELETE FROM candidates;"
    "INSERT INTO candidates(id, node_from, node_to, verdict, pose, score, overlap, chi2, reason,"
    " rms, correction, turn, through, figure, source)"
    " SELECT id, node_from, node_to, verdict, pose, score, overlap, chi2, reason, rms, correction,"
    " turn, through, figure, source FROM end_candidates;"
    "DELETE FROM edges WHERE id NOT IN (SELECT id FROM end_edges);"
    "UPDATE edges SET status = was.status FROM end_edges AS was WHERE was.id = edges.id;"
    "DELETE FROM fixes WHERE id NOT IN (SELECT id FROM end_fixes);"
    "UPDATE fixes SET verdict = was.verdict, chi2 = was.chi2, information = was.information,"
    " antenna = COALESCE(was.antenna, fixes.antenna)"
    " FROM end_fixes AS was WHERE was.id = fixes.id;"
    "DELETE FROM headings WHERE keyframe NOT IN (SELECT id FROM end_keyframes);"
    "DELETE FROM georeference; INSERT INTO georeference SELECT * FROM end_georeference;"
    "DELETE FROM places;"
    "DELETE FROM control WHERE keyframe NOT IN (SELECT id FROM end_keyframes);"
    "DELETE FROM chunks WHERE keyframe NOT IN (SELECT id FROM end_keyframes);"
    "DELETE FROM submaps WHERE keyframe NOT IN (SELECT id FROM end_keyframes);"
    "DELETE FROM keyframes WHERE id NOT IN (SELECT id FROM end_keyframes);"
    "UPDATE keyframes SET fixed = was.fixed, pose = was.pose FROM end_keyframes AS was"
    " WHERE was.id = keyframes.id;"
    "DELETE FROM end_keyframes; DELETE FROM end_edges; DELETE FROM end_candidates;"
    "DELETE FROM end_fixes; DELETE FROM end_georeference;";

}  // namespace

// In the transaction of the step itself.
void MapDatabase::count_step() {
  if (run_) {
    database_.prepare("UPDATE sessions SET steps = steps + 1 WHERE id = ? AND ending = 0")
        .bind(1, *run_)
        .step();
  } else {
    database_.execute("UPDATE sessions SET edited = 1");
  }
}

// Of a map that nobody runs, what is written is no end.
void MapDatabase::begin_end(Nanoseconds) {
  begins_end_ = run_.has_value();
}

// In the transaction of the step itself, so that no end is lost before there is more than it had.
void MapDatabase::prepare_step() {
  if (takes_back_ && run_ && progress(*run_).ending) {
    database_.execute(kTakeBack);
    for (const MapKeyframe& keyframe : keyframes()) {
      place(keyframe.id, keyframe.T_map_keyframe);
    }
    database_.prepare("UPDATE sessions SET ending = 0, complete = 0 WHERE id = ?")
        .bind(1, *run_)
        .step();
  }
  if (begins_end_) {
    database_.execute(kRememberAll);
    database_.prepare("UPDATE sessions SET ending = 1 WHERE id = ?").bind(1, *run_).step();
  }
}

void MapDatabase::set_complete(SessionId session) {
  SqliteTransaction transaction(database_);
  database_.prepare("UPDATE sessions SET complete = 1 WHERE id = ?").bind(1, session).step();
  transaction.commit();
}

SessionProgress MapDatabase::progress(SessionId session) const {
  if (map_schema_of(database_) < 3) {
    return {.edited = true};  // such a map does not tell
  }
  SqliteStatement row =
      database_.prepare("SELECT steps, ending, complete, edited FROM sessions WHERE id = ?");
  if (!row.bind(1, session).step()) {
    throw InputError(database_.path(), {}, "it has no session " + std::to_string(session),
                     "`adit info` lists those it has");
  }
  return {.steps = row.integer(0),
          .ending = row.integer(1) != 0,
          .complete = row.integer(2) != 0,
          .edited = row.integer(3) != 0};
}

}  // namespace adit
