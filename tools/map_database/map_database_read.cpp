// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "adit/slam/loops/loop_reason.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_records.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

template <class Enum>
Enum enumerator(int64_t value, Enum last, const std::filesystem::path& file,
                const std::string& what) {
  if (value < 0 || value > static_cast<int64_t>(last)) {
    throw InputError(file, {}, what + " " + std::to_string(value) + " is none that is known",
                     "The map is damaged");
  }
  return static_cast<Enum>(value);
}

[[noreturn]] void fail(const std::filesystem::path& file, NodeId keyframe,
                       const std::string& found) {
  throw InputError(file, {}, "submap " + std::to_string(keyframe) + " " + found,
                   "`adit check` says what else is wrong");
}

std::vector<std::byte> unpacked(int64_t bytes, std::span<const std::byte> zstd,
                                const std::filesystem::path& file, NodeId keyframe) {
  const auto size = static_cast<uint64_t>(std::max<int64_t>(0, bytes));
  Decompressor decompressor;
  const Unpacked chunk = decompressor.unpack(Compression::zstd, zstd, size);
  if (!chunk.problem.empty() || chunk.cut_off || chunk.bytes.size() != size) {
    fail(file, keyframe,
         "has a damaged chunk: " + (chunk.problem.empty() ? "it ends early" : chunk.problem));
  }
  return {chunk.bytes.begin(), chunk.bytes.end()};
}

constexpr const char* kSessions = "SELECT id, name, configuration FROM sessions";
constexpr const char* kFixes =
    "SELECT id, keyframe, stamp_ns, kind, latitude, longitude, altitude, covariance, antenna, "
    "path, verdict, chi2, information FROM fixes";
constexpr const char* kControl =
    "SELECT id, name, role, keyframe, point, marked, latitude, longitude, altitude, sigma FROM "
    "control";
constexpr const char* kHeadings =
    "SELECT id, keyframe, stamp_ns, yaw, sigma, axis, information FROM headings";
constexpr const char* kEdges =
    "SELECT id, node_from, node_to, kind, status, pose, information FROM edges";

// Columns that older schemas lack are 0, and so are their tables' rows.
constexpr int64_t kFirstWithWorld = 5;
constexpr int64_t kFirstWithControl = 8;
std::string keyframes_of(const SqliteDatabase& database) {
  return std::string("SELECT id, session, stamp_ns, fixed, pose, covariance, ") +
         (map_schema_of(database) < kFirstWithWorld ? "0" : "vertical") + " FROM keyframes";
}
std::string candidates_of(const SqliteDatabase& database) {
  const int64_t schema = map_schema_of(database);
  return std::string(
             "SELECT id, node_from, node_to, verdict, pose, score, overlap, chi2, reason, ") +
         (schema < 2 ? "0.0, 0.0, 0.0, 0.0, 0.0, " : "rms, correction, turn, through, figure, ") +
         (schema < 4 ? "0" : "source") + " FROM candidates";
}

/// What `take` makes of each row, in order of ids.
template <class Take>
auto all_rows(const SqliteDatabase& database, const std::string& select, const Take& take) {
  std::vector<decltype(take(std::declval<const SqliteStatement&>()))> all;
  SqliteStatement rows = database.prepare(select + " ORDER BY id");
  while (rows.step()) {
    all.push_back(take(rows));
  }
  return all;
}

/// What it makes of the row of that id; nothing where there is none.
template <class Take>
auto one_row(const SqliteDatabase& database, const std::string& select, int64_t id,
             const Take& take) {
  std::optional<decltype(take(std::declval<const SqliteStatement&>()))> one;
  SqliteStatement row = database.prepare(select + " WHERE id = ?");
  if (row.bind(1, id).step()) {
    one = take(row);
  }
  return one;
}

}  // namespace

MapSession MapDatabase::session_at(const SqliteStatement& row) const {
  MapSession session{row.integer(0), row.text(1), row.text(2), {}};
  SqliteStatement origin =
      database_.prepare("SELECT key, value FROM provenance WHERE session = ? ORDER BY key");
  origin.bind(1, session.id);
  while (origin.step()) {
    session.provenance.emplace_back(origin.text(0), origin.text(1));
  }
  return session;
}

MapKeyframe MapDatabase::keyframe_at(const SqliteStatement& row) const {
  MapKeyframe keyframe;
  keyframe.id = row.integer(0);
  keyframe.session = row.integer(1);
  keyframe.stamp = Nanoseconds(row.integer(2));
  keyframe.fixed = row.integer(3) != 0;
  const auto& file = database_.path();
  keyframe.T_map_keyframe =
      pose_from(numbers<12>(row.blob(4), file, "the pose of keyframe", keyframe.id));
  keyframe.covariance =
      matrix_from(numbers<36>(row.blob(5), file, "the covariance of keyframe", keyframe.id));
  keyframe.vertical =
      enumerator(row.integer(6), Vertical::rough_gravity, file, "the vertical of a keyframe");
  return keyframe;
}

PoseEdge MapDatabase::edge_at(const SqliteStatement& row) const {
  const int64_t id = row.integer(0);
  const auto& file = database_.path();
  PoseEdge edge;
  edge.from = row.integer(1);
  edge.to = row.integer(2);
  edge.kind = enumerator(row.integer(3), EdgeKind::start, file, "the kind of an edge");
  edge.status = enumerator(row.integer(4), EdgeStatus::revoked, file, "the status of an edge");
  edge.T_from_to = pose_from(numbers<12>(row.blob(5), file, "the pose of edge", id));
  edge.information = matrix_from(numbers<36>(row.blob(6), file, "the information of edge", id));
  return edge;
}

LoopCandidate MapDatabase::candidate_at(const SqliteStatement& row) const {
  LoopCandidate candidate;
  candidate.id = row.integer(0);
  candidate.from = row.integer(1);
  candidate.to = row.integer(2);
  candidate.verdict = enumerator(row.integer(3), CandidateVerdict::revoked, database_.path(),
                                 "the verdict about a candidate");
  candidate.T_from_to =
      pose_from(numbers<12>(row.blob(4), database_.path(), "the pose of candidate", candidate.id));
  candidate.score = row.real(5);
  candidate.overlap = row.real(6);
  candidate.chi2 = row.real(7);
  candidate.reason = row.text(8);
  candidate.rms = row.real(9);
  candidate.correction = row.real(10);
  candidate.turn = row.real(11);
  candidate.through = row.real(12);
  candidate.figure = row.real(13);
  candidate.source =
      enumerator(row.integer(14), LoopSource::hand, database_.path(), "the source of a candidate");
  if (candidate.reason == to_string(LoopReason::added_by_hand)) {
    candidate.source = LoopSource::hand;  // maps of before it was a source of its own
  }
  return candidate;
}

MapFix MapDatabase::fix_at(const SqliteStatement& row) const {
  const auto& file = database_.path();
  MapFix fix;
  fix.id = row.integer(0);
  fix.keyframe = row.integer(1);
  fix.stamp = Nanoseconds(row.integer(2));
  fix.kind = enumerator(row.integer(3), GnssFixKind::ground_augmented, file, "the kind of a fix");
  fix.place = {row.real(4), row.real(5), row.real(6)};
  fix.covariance = square_from(numbers<9>(row.blob(7), file, "the covariance of fix", fix.id));
  fix.p_keyframe_antenna = vector_from(numbers<3>(row.blob(8), file, "the antenna of fix", fix.id));
  fix.path = row.real(9);
  fix.verdict = enumerator(row.integer(10), FixVerdict::apart, file, "the verdict about a fix");
  fix.chi2 = row.real(11);
  fix.information = square_from(numbers<9>(row.blob(12), file, "the information of fix", fix.id));
  return fix;
}

std::vector<MapSession> MapDatabase::sessions() const {
  return all_rows(database_, kSessions, [&](const auto& row) { return session_at(row); });
}
std::optional<MapSession> MapDatabase::session(SessionId id) const {
  return one_row(database_, kSessions, id, [&](const auto& row) { return session_at(row); });
}

std::vector<MapKeyframe> MapDatabase::keyframes() const {
  const Anchors anchored = anchors();
  return all_rows(database_, keyframes_of(database_),
                  [&](const auto& row) { return in_map(keyframe_at(row), anchored); });
}
std::optional<MapKeyframe> MapDatabase::keyframe(NodeId id) const {
  return one_row(database_, keyframes_of(database_), id,
                 [&](const auto& row) { return in_map(keyframe_at(row), anchors()); });
}

std::vector<PoseEdge> MapDatabase::edges() const {
  return all_rows(database_, kEdges, [&](const auto& row) { return edge_at(row); });
}
std::optional<PoseEdge> MapDatabase::edge(int64_t id) const {
  return one_row(database_, kEdges, id, [&](const auto& row) { return edge_at(row); });
}

std::vector<LoopCandidate> MapDatabase::candidates() const {
  return all_rows(database_, candidates_of(database_),
                  [&](const auto& row) { return candidate_at(row); });
}
std::optional<LoopCandidate> MapDatabase::candidate(int64_t id) const {
  return one_row(database_, candidates_of(database_), id,
                 [&](const auto& row) { return candidate_at(row); });
}

ControlPoint MapDatabase::control_point_at(const SqliteStatement& row) const {
  const auto& file = database_.path();
  const int64_t id = row.integer(0);
  ControlPoint point;
  point.name = row.text(1);
  point.role = enumerator(row.integer(2), ControlRole::check, file, "the role of control point");
  point.keyframe = row.integer(3);
  point.p_keyframe = vector_from(numbers<3>(row.blob(4), file, "the point of control point", id));
  point.p_marked = vector_from(numbers<3>(row.blob(5), file, "the mark of control point", id));
  point.place = {row.real(6), row.real(7), row.real(8)};
  point.sigma = vector_from(numbers<3>(row.blob(9), file, "the deviations of control point", id));
  return point;
}

std::vector<ControlPoint> MapDatabase::control_points() const {
  if (map_schema_of(database_) < kFirstWithControl) {
    return {};
  }
  return all_rows(database_, kControl, [&](const auto& row) { return control_point_at(row); });
}
std::optional<ControlPoint> MapDatabase::control_point(int64_t id) const {
  if (map_schema_of(database_) < kFirstWithControl) {
    return std::nullopt;
  }
  return one_row(database_, kControl, id, [&](const auto& row) { return control_point_at(row); });
}

MapHeading MapDatabase::heading_at(const SqliteStatement& row) const {
  MapHeading heading;
  heading.keyframe = row.integer(1);
  heading.stamp = Nanoseconds(row.integer(2));
  heading.yaw = row.real(3);
  heading.sigma = row.real(4);
  heading.axis_keyframe =
      vector_from(numbers<3>(row.blob(5), database_.path(), "the axis of heading", row.integer(0)));
  heading.information = row.real(6);
  heading.verdict = HeadingVerdict::used;
  return heading;
}

std::vector<MapHeading> MapDatabase::headings() const {
  if (map_schema_of(database_) < kFirstWithHeadings) {
    return {};
  }
  return all_rows(database_, kHeadings, [&](const auto& row) { return heading_at(row); });
}
std::optional<MapHeading> MapDatabase::heading(int64_t id) const {
  if (map_schema_of(database_) < kFirstWithHeadings) {
    return std::nullopt;
  }
  return one_row(database_, kHeadings, id, [&](const auto& row) { return heading_at(row); });
}

std::vector<MapFix> MapDatabase::fixes() const {
  if (map_schema_of(database_) < kFirstWithWorld) {
    return {};
  }
  return all_rows(database_, kFixes, [&](const auto& row) { return fix_at(row); });
}
std::optional<MapFix> MapDatabase::fix(int64_t id) const {
  if (map_schema_of(database_) < kFirstWithWorld) {
    return std::nullopt;
  }
  return one_row(database_, kFixes, id, [&](const auto& row) { return fix_at(row); });
}

std::optional<Georeference> MapDatabase::georeference() const {
  if (map_schema_of(database_) < kFirstWithWorld) {
    return std::nullopt;
  }
  return one_row(
      database_, "SELECT id, latitude, longitude, altitude, pose, covariance FROM georeference", 1,
      [&](const SqliteStatement& row) {
        const auto& file = database_.path();
        Georeference georeference;
        georeference.origin = {row.real(1), row.real(2), row.real(3)};
        georeference.T_world_map =
            pose_from(numbers<12>(row.blob(4), file, "the pose of georeference", 1));
        georeference.covariance =
            matrix_from(numbers<36>(row.blob(5), file, "the covariance of georeference", 1));
        return georeference;
      });
}

PoseGraph MapDatabase::graph() const {
  PoseGraph graph;
  try {
    for (const MapKeyframe& keyframe : keyframes()) {
      graph.add_node({keyframe.id, keyframe.T_map_keyframe, keyframe.fixed});
      if (const auto level = level_of(keyframe.id, keyframe.vertical)) {
        graph.add_level(*level);
      }
    }
    for (const PoseEdge& edge : edges()) {
      graph.add_edge(edge);
    }
    if (const std::optional<Georeference> world = georeference()) {
      const WorldFrame frame(world->origin);
      for (const MapFix& fix : fixes()) {
        if (fix.verdict == FixVerdict::used) {
          graph.add_fix(as_measured(fix, frame));
        }
      }
      graph.set_T_world_map(world->T_world_map);
      for (const MapHeading& heading : headings()) {
        graph.add_heading(as_measured(heading, graph, frame));
      }
      for (const ControlPoint& point : control_points()) {
        if (point.role == ControlRole::control) {
          graph.add_fix(as_measured(point, frame));
        }
      }
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(database_.path(), {}, error.what(), "The map is damaged");
  } catch (const GraphError& error) {
    throw InputError(database_.path(), {}, error.what(), "The map is damaged");
  }
  return graph;
}

MapSubmap MapDatabase::submap(NodeId keyframe) const {
  SqliteStatement read = database_.prepare("SELECT box, chunks FROM submaps WHERE keyframe = ?");
  if (!read.bind(1, keyframe).step()) {
    fail(database_.path(), keyframe, "does not exist");
  }
  const auto box = numbers<6>(read.blob(0), database_.path(), "the box of submap", keyframe);
  MapSubmap submap{{box[0], box[1], box[2]}, {box[3], box[4], box[5]}, {}};
  const auto count = static_cast<std::size_t>(read.integer(1));
  SqliteStatement chunks =
      database_.prepare("SELECT bytes, zstd FROM chunks WHERE keyframe = ? ORDER BY number");
  chunks.bind(1, keyframe);
  while (chunks.step()) {
    submap.chunks.push_back(
        unpacked(chunks.integer(0), chunks.blob(1), database_.path(), keyframe));
  }
  if (submap.chunks.size() != count) {
    fail(
        database_.path(), keyframe,
        "has " + std::to_string(submap.chunks.size()) + " of " + std::to_string(count) + " chunks");
  }
  return submap;
}

std::vector<std::byte> MapDatabase::chunk(NodeId keyframe, std::size_t number) const {
  SqliteStatement read =
      database_.prepare("SELECT bytes, zstd FROM chunks WHERE keyframe = ? AND number = ?");
  if (!read.bind(1, keyframe).bind(2, static_cast<int64_t>(number)).step()) {
    fail(database_.path(), keyframe, "has no chunk " + std::to_string(number));
  }
  return unpacked(read.integer(0), read.blob(1), database_.path(), keyframe);
}

std::vector<NodeId> MapDatabase::submaps_within(const Eigen::Vector3d& lower,
                                                const Eigen::Vector3d& upper) const {
  SqliteStatement read = database_.prepare(
      "SELECT keyframe FROM places WHERE max_x >= ? AND min_x <= ? AND max_y >= ? AND min_y <= ?"
      " AND max_z >= ? AND min_z <= ? ORDER BY keyframe");
  for (int axis = 0; axis < 3; ++axis) {
    read.bind(1 + 2 * axis, lower[axis]).bind(2 + 2 * axis, upper[axis]);
  }
  std::vector<NodeId> found;
  while (read.step()) {
    found.push_back(read.integer(0));
  }
  return found;
}

std::map<NodeId, Eigen::AlignedBox3d> MapDatabase::boxes() const {
  std::map<NodeId, Eigen::AlignedBox3d> boxes;
  SqliteStatement rows =
      database_.prepare("SELECT keyframe, min_x, min_y, min_z, max_x, max_y, max_z FROM places");
  while (rows.step()) {
    boxes.emplace(rows.integer(0),
                  Eigen::AlignedBox3d(Eigen::Vector3d(rows.real(1), rows.real(2), rows.real(3)),
                                      Eigen::Vector3d(rows.real(4), rows.real(5), rows.real(6))));
  }
  return boxes;
}

}  // namespace adit
