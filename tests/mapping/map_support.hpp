// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/graph_support.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/row_checksums.hpp"

namespace adit::test {

/// The keyframe of that number, 10 m on along x from the one before, with three chunks.
inline KeyframeRecord record(NodeId id, SessionId session) {
  KeyframeRecord record;
  record.keyframe.id = id;
  record.keyframe.session = session;
  record.keyframe.stamp = Nanoseconds(1'700'000'000'123'456'789 + 100'000'000 * id);
  record.keyframe.T_map_keyframe = step(10.0 * static_cast<double>(id), 0.0);
  record.keyframe.covariance = Matrix6d::Identity() / (3.0 + static_cast<double>(id));
  record.submap.lower = {-4.0, -3.0, -1.0};
  record.submap.upper = {5.0, 3.0, 2.0};
  for (std::size_t chunk = 0; chunk < 3; ++chunk) {
    std::vector<std::byte> bytes(1000 * chunk);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      bytes[i] = static_cast<std::byte>((i * i + chunk + static_cast<std::size_t>(id)) % 251);
    }
    record.submap.chunks.push_back(bytes);
  }
  if (id > 0) {
    record.edges.push_back(edge(id - 1, id, step(10.0), 100.0 + static_cast<double>(id) / 3.0));
  }
  return record;
}

/// The same with a submap of one point, 1 m to the left and 2 m above; the third one's has moved.
inline KeyframeRecord record_of_a_point(NodeId id, SessionId session) {
  KeyframeRecord result = record(id, session);
  KeyframeSubmap submap;
  submap.sweeps.push_back({.stamp = result.keyframe.stamp, .merged = true});
  submap.points.push_back({.place = {0, 2048, 4096}, .seen_through = id == 2});
  result.submap = encode(submap);
  return result;
}

inline SessionId add_session(MapStore& map) {
  return map.add_session({.name = "first",
                          .configuration = "[preprocess]\nr_input = 0.25\n",
                          .provenance = {{"input", "abc123"}, {"device", "llvmpipe"}}});
}

/// Of six keyframes 10 m apart: a loop that has the last 1 m nearer to the first, and one that was
/// rejected.
inline MapRevision loops_of_six() {
  const PoseEdge loop = edge(0, 5, step(49.0), 400.0);
  return {.edges = {loop},
          .candidates = {LoopCandidate{.id = 1,
                                       .from = 0,
                                       .to = 5,
                                       .T_from_to = loop.T_from_to,
                                       .overlap = 0.82,
                                       .verdict = CandidateVerdict::accepted,
                                       .reason = "none",
                                       .correction = 1.0,
                                       .figure = 3.0},
                         LoopCandidate{.id = 2,
                                       .from = 1,
                                       .to = 5,
                                       .overlap = 0.12,
                                       .verdict = CandidateVerdict::rejected,
                                       .reason = "too_little_overlap",
                                       .figure = 0.12}}};
}

/// A map with rows in every table: six keyframes, a loop, two fixes and headings, a control point,
/// an anchor, a place on the Earth, and what its end has changed.
inline void write_full_map(const std::filesystem::path& file) {
  MapDatabase map(file, MapAccess::write);
  const SessionId session = add_session(map);
  map.begin_run(session);
  for (NodeId id = 0; id < 6; ++id) {
    KeyframeRecord keyframe = record_of_a_point(id, session);
    keyframe.keyframe.vertical = Vertical::gravity;
    if (id % 3 == 1) {
      keyframe.fixes = {{.id = 1 + id / 3,
                         .keyframe = id,
                         .stamp = keyframe.keyframe.stamp,
                         .kind = GnssFixKind::satellite_augmented,
                         .place = {48.0 + 1e-4 * static_cast<double>(id), 11.1, 500.25},
                         .covariance = Eigen::Matrix3d::Identity(),
                         .p_keyframe_antenna = {0.1, 0.2, 0.3},
                         .path = 10.5 * static_cast<double>(id),
                         .verdict = FixVerdict::used,
                         .information = Eigen::Matrix3d::Identity(),
                         .chi2 = 0.5}};
    }
    map.store(keyframe);
  }
  map.revise(loops_of_six());
  map.set_anchor(session, step(3.0, 0.25));
  const Georeference world{.origin = {48.0, 11.1, 500.25},
                           .T_world_map = step(3.0, 0.5),
                           .covariance = 2.0 * Matrix6d::Identity()};
  map.revise({.headings = std::vector<MapHeading>{{.keyframe = 2,
                                                   .stamp = Nanoseconds(200),
                                                   .yaw = 0.25,
                                                   .sigma = 0.0175,
                                                   .axis_keyframe = Eigen::Vector3d::UnitX(),
                                                   .information = 100.5},
                                                  {.keyframe = 4,
                                                   .stamp = Nanoseconds(400),
                                                   .yaw = -0.25,
                                                   .sigma = 0.0175,
                                                   .axis_keyframe = Eigen::Vector3d::UnitX(),
                                                   .information = 100.5}},
              .georeference = world,
              .control = std::vector<ControlPoint>{{.name = "church",
                                                    .role = ControlRole::control,
                                                    .keyframe = 2,
                                                    .p_keyframe = {1.0, 2.0, 0.5},
                                                    .p_marked = {21.0, 2.0, 0.5},
                                                    .place = {48.0001, 11.1001, 501.5},
                                                    .sigma = {0.02, 0.02, 0.04}}}});
  map.begin_end(record(5, session).keyframe.stamp);
  map.revise({.statuses = {{0, EdgeStatus::revoked}}});
  map.set_complete(session);
}

/// Takes from a map's file what schema 8 did not have.
inline void make_schema_8(const std::filesystem::path& file) {
  const SqliteDatabase raw(file, SqliteDatabase::Mode::update);
  raw.execute("DROP TABLE headings");
  for (const ChecksummedTable& table : kChecksummedTables) {
    if (table.name == std::string_view("headings")) {
      continue;
    }
    raw.execute(std::string("ALTER TABLE ") + table.name + " DROP COLUMN checksum");
  }
  raw.execute("PRAGMA user_version = 8");
}

inline std::string dump_of(const MapDatabase& map) {
  std::string text;
  map.dump([&](std::string_view line) { text += std::string(line) + "\n"; });
  return text;
}

}  // namespace adit::test
