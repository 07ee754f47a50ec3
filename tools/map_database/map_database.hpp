// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A map in one file: SQLite in WAL mode with synchronous=FULL, so that what was stored survives
// kill -9 and a loss of power. Submaps are compressed; an R*Tree of their boxes in the map frame
// (float32 metres) finds them by place.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/mapping/map_store.hpp"
#include "adit/tools/containers/sqlite_database.hpp"
#include "adit/tools/map_database/map_schema.hpp"
#include "adit/tools/map_database/writer_lock.hpp"

namespace adit {

/// What a map is opened for.
enum class MapAccess {
  read,   ///< any number, also beside a writer
  write,  ///< one at a time; makes the file where there is none
};

/// How far the run that fills a session has come.
struct SessionProgress {
  int64_t steps = 0;      ///< calls of store() and revise() before begin_end()
  bool ending = false;    ///< begin_end() was called
  bool complete = false;  ///< the run has reached the end of its recording
  bool edited = false;    ///< something else has written to the map since the run began
};

/// T_map_session of the sessions that have another frame than the map: their anchors.
using Anchors = std::map<SessionId, Eigen::Isometry3d>;

/// A keyframe of its session's frame in the map's, and a pose back.
MapKeyframe in_map(MapKeyframe keyframe, const Anchors& anchors);
/// The pose that a keyframe has in its session's own frame.
Eigen::Isometry3d in_session(SessionId session, const Eigen::Isometry3d& T_map_keyframe,
                             const Anchors& anchors);

/// A map in a file of SQLite; docs/formats.md has its tables.
class MapDatabase final : public MapStore {
 public:
  /// `max_pages` bounds the file's size, in pages of 4096 bytes; 0: only the disk does. Throws
  /// InputError (missing, damaged, no map, of a newer schema), LockedError, OutputError.
  MapDatabase(const std::filesystem::path& file, MapAccess access, int64_t max_pages = 0);
  /// A writer's end leaves one file.
  ~MapDatabase() override;
  MapDatabase(const MapDatabase&) = delete;
  MapDatabase& operator=(const MapDatabase&) = delete;

  // All members throw OutputError where a map that is being written fails, for example on a full
  // disk (then nothing of the call is stored), and InputError where what is read is damaged.
  /// Throws OutputError, then nothing of it is stored.
  SessionId add_session(const MapSession& session) override;
  /// Throws OutputError, then nothing of it is stored.
  void store(const KeyframeRecord& record) override;
  void revise(const MapRevision& revision) override;
  /// In the transaction of the next step.
  void begin_end(Nanoseconds last_sweep) override;

  /// What is written from now on belongs to the run of that session, and counts as its steps. What
  /// is written without a run is an edit of the map.
  void begin_run(SessionId session) { run_ = session; }
  /// With the next step of its run the map is, but for that, as it was before begin_end(), if that
  /// was ever called.
  void take_end_back() { takes_back_ = true; }
  /// Nothing is left to go on with.
  void set_complete(SessionId session);
  /// How far the session's run came.
  SessionProgress progress(SessionId session) const;
  /// As it was opened.
  const std::filesystem::path& file() const { return database_.path(); }

  /// What the map holds now, as a new map in `file`. Throws OutputError.
  void copy_to(const std::filesystem::path& file) const;

  /// Moves a session with all its keyframes in the map, whose frame the first one gives: what
  /// merging maps comes to, and an edit of the map.
  void set_anchor(SessionId session, const Eigen::Isometry3d& T_map_session);
  /// Where each session lies in the map.
  Anchors anchors() const;

  std::vector<MapSession> sessions() const override;
  std::vector<MapKeyframe> keyframes() const override;
  PoseGraph graph() const override;
  std::vector<LoopCandidate> candidates() const override;
  std::vector<MapFix> fixes() const override;
  std::vector<MapHeading> headings() const override;
  std::optional<Georeference> georeference() const override;
  MapSubmap submap(NodeId keyframe) const override;
  std::vector<std::byte> chunk(NodeId keyframe, std::size_t number) const override;
  std::vector<NodeId> submaps_within(const Eigen::Vector3d& lower,
                                     const Eigen::Vector3d& upper) const override;

  /// Surveyed points, in the order in which they were given.
  std::vector<ControlPoint> control_points() const;
  /// The boxes around submaps, map frame, m, as the index of places has them.
  std::map<NodeId, Eigen::AlignedBox3d> boxes() const;

  /// One row each; nothing where there is none of that number. Edges are counted from 1 here.
  std::optional<MapSession> session(SessionId id) const;
  /// As above.
  std::optional<MapKeyframe> keyframe(NodeId id) const;
  /// As above.
  std::optional<PoseEdge> edge(int64_t id) const;
  /// As above.
  std::optional<LoopCandidate> candidate(int64_t id) const;
  /// As above.
  std::optional<MapFix> fix(int64_t id) const;
  /// As above.
  std::optional<MapHeading> heading(int64_t id) const;
  /// As above.
  std::optional<ControlPoint> control_point(int64_t id) const;

  /// Its rows have checksums: it was written by a schema that has them.
  bool has_checksums() const;
  /// What is wrong with the map, for people; empty: it is whole. Reads everything.
  std::vector<std::string> check() const;

  /// All content as text, line by line, for comparing: the same map gives the same lines.
  void dump(const std::function<void(std::string_view)>& line) const;

 private:
  class Check;

  void insert(const PoseEdge& edge);
  void insert(const LoopCandidate& candidate);
  void insert(const MapFix& fix);
  void insert(const MapHeading& heading);
  void insert(const ControlPoint& point);
  void insert(const Georeference& georeference);
  void place(NodeId keyframe, const Eigen::Isometry3d& pose);
  std::optional<Eigen::AlignedBox3d> place_of(NodeId keyframe, const Eigen::Isometry3d& pose) const;
  void prepare_step();
  void count_step();
  std::vector<PoseEdge> edges() const;
  MapSession session_at(const SqliteStatement& row) const;
  MapKeyframe keyframe_at(const SqliteStatement& row) const;
  PoseEdge edge_at(const SqliteStatement& row) const;
  LoopCandidate candidate_at(const SqliteStatement& row) const;
  MapFix fix_at(const SqliteStatement& row) const;
  MapHeading heading_at(const SqliteStatement& row) const;
  ControlPoint control_point_at(const SqliteStatement& row) const;

  std::optional<WriterLock> lock_;
  SqliteDatabase database_;
  std::optional<SessionId> run_;
  bool takes_back_ = false;  ///< with the next step
  bool begins_end_ = false;
};

}  // namespace adit
