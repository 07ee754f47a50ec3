// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/map_database.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "adit/tools/containers/compression.hpp"
#include "adit/tools/map_database/map_records.hpp"
#include "adit/tools/map_database/row_checksums.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

bool has_beside(const fs::path& file, const char* suffix) {
  std::error_code none;
  const auto size = fs::file_size(file.string() + suffix, none);
  return !none && size > 0;
}

bool has_log(const fs::path& file) {
  return has_beside(file, "-wal");
}

/// How to read a map so that nothing changes beside it: what its writer has left there stays, and
/// what reading makes goes.
SqliteDatabase::Mode reading_mode(const fs::path& file) {
  if (has_log(file) || has_beside(file, "-journal")) {
    return SqliteDatabase::Mode::read;
  }
  const bool writable = ::access(file.c_str(), W_OK) == 0;
  return writable || has_beside(file, ".lock") ? SqliteDatabase::Mode::share
                                               : SqliteDatabase::Mode::frozen;
}

/// A reader needs a file beside the map for the WAL's index. In a folder that cannot be written to
/// it does without, as long as there is no log that it would have to read.
SqliteDatabase open_to_read(const fs::path& file) {
  std::error_code error;
  if (fs::status(file, error).type() == fs::file_type::not_found) {
    throw InputError(file, {}, "there is no such file", "Name a map that `adit run` has made");
  }
  if (error) {
    throw InputError(file, {}, "cannot be looked at: " + error.message(),
                     "Check the permissions of its folder");
  }
  try {
    SqliteDatabase database(file, reading_mode(file));
    static_cast<void>(map_schema_of(database));
    static_cast<void>(database.prepare("SELECT count(*) FROM sqlite_schema").step());
    return database;
  } catch (const InputError&) {
    if (has_log(file)) {
      throw;
    }
    return {file, SqliteDatabase::Mode::frozen};
  }
}

SqliteDatabase open_map(const fs::path& file, MapAccess access) {
  return access == MapAccess::read ? open_to_read(file)
                                   : SqliteDatabase(file, SqliteDatabase::Mode::update);
}

}  // namespace

MapDatabase::MapDatabase(const fs::path& file, MapAccess access, int64_t max_pages)
    : lock_(access == MapAccess::write ? std::optional<WriterLock>(std::in_place, file)
                                       : std::nullopt),
      database_(open_map(file, access)) {
  database_.execute("PRAGMA busy_timeout = 10000; PRAGMA foreign_keys = ON");
  define_row_checksum(database_);
  if (access == MapAccess::write) {
    if (max_pages > 0) {
      database_.execute("PRAGMA max_page_count = " + std::to_string(max_pages));
    }
    database_.execute("PRAGMA temp_store = MEMORY");
    if (is_blank_map(database_)) {
      create_map_tables(database_);
    }
    require_map(database_);
    database_.execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL");
    migrate_map(database_);
    keep_row_checksums(database_);
  } else {
    require_map(database_);
  }
}

MapDatabase::~MapDatabase() {
  if (lock_) {
    try {
      database_.execute("PRAGMA wal_checkpoint(TRUNCATE)");
    } catch (const FileError&) {
      // The log stays beside the map, and is read with it.
    }
  }
}

void MapDatabase::copy_to(const fs::path& file) const {
  Draft draft(file);
  std::error_code none;
  fs::remove(draft.path(), none);
  database_.copy_to(draft.path());
  draft.take_its_place();
}

SessionId MapDatabase::add_session(const MapSession& session) {
  SqliteTransaction transaction(database_);
  SqliteStatement insert =
      database_.prepare("INSERT INTO sessions(name, configuration) VALUES(?, ?) RETURNING id");
  insert.bind(1, session.name).bind(2, session.configuration).step();
  const SessionId id = insert.integer(0);
  insert.reset();
  SqliteStatement add =
      database_.prepare("INSERT INTO provenance(session, key, value) VALUES(?, ?, ?)");
  for (const auto& [key, value] : session.provenance) {
    add.bind(1, id).bind(2, key).bind(3, value).step();
    add.reset();
  }
  transaction.commit();
  return id;
}

void MapDatabase::store(const KeyframeRecord& record) {
  const MapKeyframe& keyframe = record.keyframe;
  SqliteTransaction transaction(database_);
  prepare_step();
  database_
      .prepare(
          "INSERT INTO keyframes(id, session, stamp_ns, fixed, pose, covariance, vertical)"
          " VALUES(?, ?, ?, ?, ?, ?, ?)")
      .bind(1, keyframe.id)
      .bind(2, keyframe.session)
      .bind(3, int64_t{keyframe.stamp.count()})
      .bind(4, int64_t{keyframe.fixed})
      .bind(5, as_bytes(
                   pose_numbers(in_session(keyframe.session, keyframe.T_map_keyframe, anchors()))))
      .bind(6, as_bytes(matrix_numbers(keyframe.covariance)))
      .bind(7, static_cast<int64_t>(keyframe.vertical))
      .step();
  std::array<double, 6> box{};
  Eigen::Map<Vector6d>(box.data()) << record.submap.lower, record.submap.upper;
  database_.prepare("INSERT INTO submaps(keyframe, box, chunks) VALUES(?, ?, ?)")
      .bind(1, keyframe.id)
      .bind(2, as_bytes(box))
      .bind(3, static_cast<int64_t>(record.submap.chunks.size()))
      .step();
  SqliteStatement chunk =
      database_.prepare("INSERT INTO chunks(keyframe, number, bytes, zstd) VALUES(?, ?, ?, ?)");
  for (std::size_t i = 0; i < record.submap.chunks.size(); ++i) {
    const std::vector<std::byte>& bytes = record.submap.chunks[i];
    chunk.bind(1, keyframe.id)
        .bind(2, static_cast<int64_t>(i))
        .bind(3, static_cast<int64_t>(bytes.size()))
        .bind(4, compress(Compression::zstd, bytes))
        .step();
    chunk.reset();
  }
  place(keyframe.id, keyframe.T_map_keyframe);
  for (const PoseEdge& edge : record.edges) {
    insert(edge);
  }
  for (const LoopCandidate& candidate : record.candidates) {
    insert(candidate);
  }
  for (const MapFix& fix : record.fixes) {
    insert(fix);
  }
  count_step();
  transaction.commit();
  takes_back_ = begins_end_ = false;
}

void MapDatabase::revise(const MapRevision& revision) {
  SqliteTransaction transaction(database_);
  prepare_step();
  for (const PoseEdge& edge : revision.edges) {
    insert(edge);
  }
  for (const LoopCandidate& candidate : revision.candidates) {
    insert(candidate);
  }
  for (const MapFix& fix : revision.fixes) {
    insert(fix);
  }
  if (revision.headings) {
    database_.execute("DELETE FROM headings");
    for (const MapHeading& heading : *revision.headings) {
      insert(heading);
    }
  }
  if (revision.control) {
    database_.execute("DELETE FROM control");
    for (const ControlPoint& point : *revision.control) {
      insert(point);
    }
  }
  if (revision.drops_georeference) {
    database_.execute("DELETE FROM georeference");
  }
  if (revision.georeference) {
    insert(*revision.georeference);
  }
  for (const auto& [edge, status] : revision.statuses) {
    database_.prepare("UPDATE edges SET status = ? WHERE id = ?")
        .bind(1, static_cast<int64_t>(status))
        .bind(2, static_cast<int64_t>(edge) + 1)
        .step();
  }
  SqliteStatement move = database_.prepare("UPDATE keyframes SET pose = ?, fixed = ? WHERE id = ?");
  const Anchors anchored = anchors();
  for (const PoseNode& node : revision.poses) {
    const std::optional<MapKeyframe> old =
        anchored.empty() ? std::nullopt : this->keyframe(node.id);
    const Eigen::Isometry3d pose =
        old ? in_session(old->session, node.T_map_node, anchored) : node.T_map_node;
    move.bind(1, as_bytes(pose_numbers(pose))).bind(2, int64_t{node.fixed}).bind(3, node.id).step();
    move.reset();
    place(node.id, node.T_map_node);
  }
  count_step();
  transaction.commit();
  takes_back_ = begins_end_ = false;
}

void MapDatabase::insert(const PoseEdge& edge) {
  database_
      .prepare(
          "INSERT INTO edges(node_from, node_to, kind, status, pose, information)"
          " VALUES(?, ?, ?, ?, ?, ?)")
      .bind(1, edge.from)
      .bind(2, edge.to)
      .bind(3, static_cast<int64_t>(edge.kind))
      .bind(4, static_cast<int64_t>(edge.status))
      .bind(5, as_bytes(pose_numbers(edge.T_from_to)))
      .bind(6, as_bytes(matrix_numbers(edge.information)))
      .step();
}

void MapDatabase::insert(const LoopCandidate& candidate) {
  const std::string columns =
      "candidates(node_from, node_to, verdict, pose, score, overlap, chi2, reason, rms, correction,"
      " turn, through, figure, source";
  SqliteStatement statement =
      candidate.id == 0
          ? database_.prepare("INSERT INTO " + columns +
                              ") VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
          : database_.prepare("INSERT OR REPLACE INTO " + columns +
                              ", id) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  statement.bind(1, candidate.from)
      .bind(2, candidate.to)
      .bind(3, static_cast<int64_t>(candidate.verdict))
      .bind(4, as_bytes(pose_numbers(candidate.T_from_to)))
      .bind(5, candidate.score)
      .bind(6, candidate.overlap)
      .bind(7, candidate.chi2)
      .bind(8, candidate.reason)
      .bind(9, candidate.rms)
      .bind(10, candidate.correction)
      .bind(11, candidate.turn)
      .bind(12, candidate.through)
      .bind(13, candidate.figure)
      .bind(14, static_cast<int64_t>(candidate.source));
  if (candidate.id != 0) {
    statement.bind(15, candidate.id);
  }
  statement.step();
}

void MapDatabase::insert(const MapFix& fix) {
  database_
      .prepare(
          "INSERT OR REPLACE INTO fixes(id, keyframe, stamp_ns, kind, latitude, longitude,"
          " altitude, covariance, antenna, path, verdict, chi2, information)"
          " VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .bind(1, fix.id)
      .bind(2, fix.keyframe)
      .bind(3, int64_t{fix.stamp.count()})
      .bind(4, static_cast<int64_t>(fix.kind))
      .bind(5, fix.place.latitude)
      .bind(6, fix.place.longitude)
      .bind(7, fix.place.altitude)
      .bind(8, as_bytes(square_numbers(fix.covariance)))
      .bind(9, as_bytes(vector_numbers(fix.p_keyframe_antenna)))
      .bind(10, fix.path)
      .bind(11, static_cast<int64_t>(fix.verdict))
      .bind(12, fix.chi2)
      .bind(13, as_bytes(square_numbers(fix.information)))
      .step();
}

void MapDatabase::insert(const MapHeading& heading) {
  database_
      .prepare(
          "INSERT INTO headings(keyframe, stamp_ns, yaw, sigma, axis, information)"
          " VALUES(?, ?, ?, ?, ?, ?)")
      .bind(1, heading.keyframe)
      .bind(2, int64_t{heading.stamp.count()})
      .bind(3, heading.yaw)
      .bind(4, heading.sigma)
      .bind(5, as_bytes(vector_numbers(heading.axis_keyframe)))
      .bind(6, heading.information)
      .step();
}

void MapDatabase::insert(const ControlPoint& point) {
  database_
      .prepare(
          "INSERT INTO control(name, role, keyframe, point, marked, latitude, longitude, altitude,"
          " sigma) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .bind(1, point.name)
      .bind(2, static_cast<int64_t>(point.role))
      .bind(3, point.keyframe)
      .bind(4, as_bytes(vector_numbers(point.p_keyframe)))
      .bind(5, as_bytes(vector_numbers(point.p_marked)))
      .bind(6, point.place.latitude)
      .bind(7, point.place.longitude)
      .bind(8, point.place.altitude)
      .bind(9, as_bytes(vector_numbers(point.sigma)))
      .step();
}

void MapDatabase::insert(const Georeference& georeference) {
  database_
      .prepare(
          "INSERT OR REPLACE INTO georeference(id, latitude, longitude, altitude, pose, covariance)"
          " VALUES(1, ?, ?, ?, ?, ?)")
      .bind(1, georeference.origin.latitude)
      .bind(2, georeference.origin.longitude)
      .bind(3, georeference.origin.altitude)
      .bind(4, as_bytes(pose_numbers(georeference.T_world_map)))
      .bind(5, as_bytes(matrix_numbers(georeference.covariance)))
      .step();
}

// The box of the submap's box, turned into the map frame; nothing where there is no submap.
std::optional<Eigen::AlignedBox3d> MapDatabase::place_of(NodeId keyframe,
                                                         const Eigen::Isometry3d& pose) const {
  SqliteStatement read = database_.prepare("SELECT box FROM submaps WHERE keyframe = ?");
  if (!read.bind(1, keyframe).step()) {
    return std::nullopt;
  }
  const auto box = numbers<6>(read.blob(0), database_.path(), "the box of submap", keyframe);
  const Eigen::Vector3d lower(box[0], box[1], box[2]);
  const Eigen::Vector3d upper(box[3], box[4], box[5]);
  const Eigen::Vector3d centre = pose * (0.5 * (lower + upper));
  const Eigen::Vector3d reach = pose.linear().cwiseAbs() * (0.5 * (upper - lower));
  Eigen::AlignedBox3d place;
  place.min() = centre - reach;
  place.max() = centre + reach;
  return place;
}

void MapDatabase::place(NodeId keyframe, const Eigen::Isometry3d& pose) {
  const std::optional<Eigen::AlignedBox3d> place = place_of(keyframe, pose);
  if (!place) {
    return;
  }
  SqliteStatement insert =
      database_.prepare("INSERT OR REPLACE INTO places VALUES(?, ?, ?, ?, ?, ?, ?)");
  insert.bind(1, keyframe);
  for (int axis = 0; axis < 3; ++axis) {
    insert.bind(2 + 2 * axis, place->min()[axis]);
    insert.bind(3 + 2 * axis, place->max()[axis]);
  }
  insert.step();
}

}  // namespace adit
