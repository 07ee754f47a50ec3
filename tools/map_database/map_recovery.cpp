// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/map_recovery.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tools/containers/sqlite_database.hpp"
#include "adit/tools/map_database/id_ranges.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/map_salvage.hpp"
#include "adit/tools/map_database/unfinished_map.hpp"
#include "adit/tools/map_database/writer_lock.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Of a session that cannot be read.
constexpr const char* kStandIn = "recovered";

constexpr const char* kNothing =
    "Nothing can be recovered: take an older copy, or map the recording again";

/// Throws LockedError where the map has a writer, whose pages change while they are read.
void require_no_writer(const fs::path& map) {
  if (const std::optional<std::string> writer = writer_of(map)) {
    throw LockedError(map, map.string() + ": is being written by " + *writer +
                               ". Wait until that has ended, or copy the map with its -wal and "
                               "recover the copy.");
  }
}

class Recovery {
 public:
  Recovery(const fs::path& rows, const fs::path& whole, MapSalvage salvage)
      : salvage_(std::move(salvage)),
        source_(rows, MapAccess::read),
        target_(whole, MapAccess::write) {
    done_.damaged_pages = salvage_.damaged_pages;
  }

  MapRecovery run() {
    each("sessions", [&](int64_t id) { take_session(id); });
    each("keyframes", [&](int64_t id) { take_keyframe(id); });
    const auto lost_edges = each("edges", [&](int64_t id) { take_edge(id); });
    const auto lost_candidates = each("candidates", [&](int64_t id) { take_candidate(id); });
    const auto lost_fixes = each("fixes", [&](int64_t id) { take_fix(id); });
    const auto lost_control = each("control", [&](int64_t id) { take_control_point(id); });
    const auto lost_headings = each("headings", [&](int64_t id) { take_heading(id); });
    done_.edges = revision_.edges.size();
    done_.candidates = revision_.candidates.size();
    done_.fixes = revision_.fixes.size();
    try {
      revision_.georeference = source_.georeference();
    } catch (const InputError& error) {
      done_.problems.push_back("the map's place in the world: " + error.found());
    }
    target_.revise(revision_);
    done_.parts = connected_components(target_.graph()).components.size();
    tell_lost_keyframes();
    tell_lost("edges", lost_edges, done_.lost_edges);
    tell_lost("candidates", lost_candidates, done_.lost_candidates);
    tell_lost("fixes", lost_fixes, done_.lost_fixes);
    tell_lost("control", lost_control, done_.lost_control);
    tell_lost("headings", lost_headings, done_.lost_headings);
    tell_changed();
    tell_unknown();
    return std::move(done_);
  }

 private:
  using Ids = std::set<int64_t>;

  /// Calls take(id) for each row that was found. Returns which of those, or of those that are known
  /// to be lost, are not in the new map.
  Ids each(const std::string& table, const std::function<void(int64_t)>& take) {
    Ids lost = salvage_.tables[table].lost;
    std::map<std::string, Ids> causes;
    for (const int64_t id : salvage_.tables[table].ids) {
      std::string cause;
      try {
        take(id);
        continue;
      } catch (const InputError& error) {
        cause = error.found();
      } catch (const GraphError& error) {
        cause = error.what();
      }
      lost.insert(id);
      causes[cause].insert(id);
    }
    for (const auto& [cause, ids] : causes) {
      done_.problems.push_back(table + " " + ranges_of(ids) + ": " + cause);
    }
    return lost;
  }

  void take_session(int64_t id) {
    const std::optional<MapSession> session = source_.session(id);
    if (session) {
      sessions_[id] = target_.add_session(*session);
      ++done_.sessions;
    }
  }

  /// One that cannot be read has a stand-in, so that its keyframes have one.
  SessionId session_of(SessionId old) {
    const auto known = sessions_.find(old);
    if (known != sessions_.end()) {
      return known->second;
    }
    done_.problems.push_back("session " + std::to_string(old) +
                             ": its name and settings are lost; it is called \"" + kStandIn + "\"");
    const std::optional<MapSession> rest = source_.session(old);  // with its provenance
    return sessions_[old] = target_.add_session(rest ? *rest : MapSession{.name = kStandIn});
  }

  void take_keyframe(int64_t id) {
    const std::optional<MapKeyframe> keyframe = source_.keyframe(id);
    if (!keyframe) {
      return;
    }
    PoseGraph().add_node(
        {.id = id, .T_map_node = keyframe->T_map_keyframe});  // throws if it is none
    KeyframeRecord record{.keyframe = *keyframe, .submap = submap_of(*keyframe)};
    record.keyframe.session = session_of(keyframe->session);
    target_.store(record);
    keyframes_.insert(id);
    ++done_.keyframes;
  }

  /// What the keyframe has seen; where that is lost its sweeps without points, and where those are
  /// lost, too, the one that it has its stamp from, at its own pose.
  MapSubmap submap_of(const MapKeyframe& keyframe) {
    KeyframeSubmap submap{.r_submap = r_submap_,
                          .vertical = keyframe.vertical,
                          .sweeps = {SubmapSweep{.stamp = keyframe.stamp}},
                          .points = {}};
    MapSubmap stored;
    std::string lost = "its sweeps";
    try {
      stored.chunks.push_back(source_.chunk(keyframe.id, kSweepChunk));
      submap = decode_sweeps(stored.chunks.front());
      r_submap_ = submap.r_submap;
      lost = "its points";
      stored.chunks.push_back(source_.chunk(keyframe.id, kSweepChunk + 1));
      submap = decode(stored);
    } catch (const InputError&) {
      return without_points(keyframe, submap, lost);
    } catch (const SubmapDamaged&) {
      return without_points(keyframe, submap, lost);
    }
    try {
      stored.chunks.push_back(source_.chunk(keyframe.id, kPlaceChunk));
      static_cast<void>(decode_descriptor(stored));
    } catch (const InputError&) {
    } catch (const SubmapDamaged&) {
      stored.chunks.pop_back();  // it is made anew from the points
    }
    const SubmapBox box = box_of(submap);
    stored.lower = box.lower;
    stored.upper = box.upper;
    return stored;
  }

  MapSubmap without_points(const MapKeyframe& keyframe, const KeyframeSubmap& submap,
                           const std::string& lost) {
    done_.without_points.insert(keyframe.id);
    (lost == "its sweeps" ? without_sweeps_ : with_sweeps_).insert(keyframe.id);
    return encode(submap);
  }

  bool has_ends(NodeId from, NodeId to) const {
    return keyframes_.contains(from) && keyframes_.contains(to);
  }

  static void require(bool has_keyframes) {
    if (!has_keyframes) {
      throw GraphError("between keyframes of which one is lost");
    }
  }

  void take_edge(int64_t id) {
    if (const std::optional<PoseEdge> edge = source_.edge(id)) {
      known_keyframes_.insert({edge->from, edge->to});
      require(has_ends(edge->from, edge->to));
      PoseGraph ends;  // which refuses an edge that no graph may have
      ends.add_node({.id = edge->from});
      ends.add_node({.id = edge->to});
      ends.add_edge(*edge);
      revision_.edges.push_back(*edge);
    }
  }

  void take_candidate(int64_t id) {
    if (const std::optional<LoopCandidate> candidate = source_.candidate(id)) {
      require(has_ends(candidate->from, candidate->to));
      revision_.candidates.push_back(*candidate);
    }
  }

  void take_fix(int64_t id) {
    if (const std::optional<MapFix> fix = source_.fix(id)) {
      known_keyframes_.insert(fix->keyframe);
      require(keyframes_.contains(fix->keyframe));
      revision_.fixes.push_back(*fix);
    }
  }

  void take_heading(int64_t id) {
    if (const std::optional<MapHeading> heading = source_.heading(id)) {
      known_keyframes_.insert(heading->keyframe);
      require(keyframes_.contains(heading->keyframe));
      if (!revision_.headings) {
        revision_.headings.emplace();
      }
      revision_.headings->push_back(*heading);
    }
  }

  void take_control_point(int64_t id) {
    if (const std::optional<ControlPoint> point = source_.control_point(id)) {
      known_keyframes_.insert(point->keyframe);
      require(keyframes_.contains(point->keyframe));
      if (!revision_.control) {
        revision_.control.emplace();
      }
      revision_.control->push_back(*point);
    }
  }

  /// Submaps, edges and fixes tell which keyframes there were.
  void tell_lost_keyframes() {
    for (const char* table : {"keyframes", "submaps", "end_keyframes"}) {
      known_keyframes_.insert(salvage_.tables[table].ids.begin(), salvage_.tables[table].ids.end());
    }
    known_keyframes_.insert(salvage_.tables["keyframes"].lost.begin(),
                            salvage_.tables["keyframes"].lost.end());
    known_keyframes_.insert(salvage_.chunk_keyframes.begin(), salvage_.chunk_keyframes.end());
    std::ranges::set_difference(known_keyframes_, keyframes_,
                                std::inserter(done_.lost_keyframes, done_.lost_keyframes.end()));
    if (!done_.lost_keyframes.empty()) {
      done_.problems.push_back("keyframes " + ranges_of(done_.lost_keyframes) + " are lost");
    }
    if (!with_sweeps_.empty()) {
      done_.problems.push_back("keyframes " + ranges_of(with_sweeps_) +
                               ": their points are lost; poses, sweeps and edges are kept");
    }
    if (!without_sweeps_.empty()) {
      done_.problems.push_back("keyframes " + ranges_of(without_sweeps_) +
                               ": their points and sweeps are lost; poses and edges are kept");
    }
  }

  void tell_lost(const std::string& table, const Ids& lost, std::size_t& count) {
    count = lost.size();
    const Ids& missing = salvage_.tables[table].lost;  // others have been told with their cause
    if (!missing.empty()) {
      done_.problems.push_back(table + " " + ranges_of(missing) + " are lost");
    }
  }

  /// Of what has no number that people know, and is told nowhere else.
  void tell_changed() {
    for (const char* table : {"provenance", "georeference", "anchors"}) {
      if (const std::size_t rows = salvage_.tables[table].changed; rows > 0) {
        done_.problems.push_back(std::string(table) + ": " + std::to_string(rows) +
                                 (rows == 1 ? " row is lost" : " rows are lost"));
      }
    }
    for (const int64_t id : salvage_.tables["sessions"].lost) {
      if (!sessions_.contains(id)) {
        done_.problems.push_back("session " + std::to_string(id) + " is lost");
      }
    }
  }

  void tell_unknown() {
    if (salvage_.log_is_damaged) {
      done_.problems.emplace_back(
          "the log beside the map: rows in its damaged frames are lost or older ones, an unknown "
          "number");
      done_.may_lack_more = true;
      return;
    }
    auto& tables = salvage_.tables;
    // Each keyframe has a submap: a whole table of those names them all.
    tables["keyframes"].may_lack_more &= tables["submaps"].may_lack_more;
    for (const char* table : {"sessions", "keyframes", "edges", "candidates", "fixes", "control",
                              "headings", "georeference", "anchors", "provenance"}) {
      if (tables[table].may_lack_more) {
        done_.problems.push_back(std::string(table) +
                                 ": more may be lost, an unknown number, which nothing else in "
                                 "the file tells of");
        done_.may_lack_more = true;
      }
    }
  }

  MapSalvage salvage_;
  MapDatabase source_;
  MapDatabase target_;
  MapRecovery done_;
  MapRevision revision_;
  std::map<SessionId, SessionId> sessions_;  ///< old to new
  std::set<NodeId> keyframes_;               ///< that are in the new map
  std::set<NodeId> known_keyframes_;
  std::set<NodeId> with_sweeps_;  ///< keyframes without points
  std::set<NodeId> without_sweeps_;
  double r_submap_ = 0.0;  ///< of the last submap that is whole
};

/// Sessions that keyframes belong to and that were not found, with what else is known of them.
void add_sessions(const fs::path& rows) {
  const SqliteDatabase database(rows, SqliteDatabase::Mode::update);
  database.execute(std::string("INSERT OR IGNORE INTO sessions(id, name, configuration) "
                               "SELECT DISTINCT session, '") +
                   kStandIn + "', '' FROM keyframes");
}

MapRecovery recover(const fs::path& damaged, const UnfinishedMap& unfinished) {
  static_cast<void>(MapDatabase(unfinished.rows(), MapAccess::write));  // makes the tables
  MapSalvage salvage = salvage_rows(damaged, unfinished.rows());
  const std::size_t pages = salvage.pages;
  if (salvage.tables["keyframes"].ids.empty() && salvage.tables["sessions"].ids.empty()) {
    throw InputError(damaged, {},
                     "no keyframe and no session of a map is in it, in " + std::to_string(pages) +
                         " pages of an SQLite database",
                     kNothing);
  }
  add_sessions(unfinished.rows());
  MapRecovery done = Recovery(unfinished.rows(), unfinished.part(), std::move(salvage)).run();
  if (done.keyframes == 0 && !done.lost_keyframes.empty()) {
    throw InputError(
        damaged, {},
        "no keyframe of it can be read, of at least " + std::to_string(done.lost_keyframes.size()),
        kNothing);
  }
  return done;
}

}  // namespace

MapRecovery recover_map(const fs::path& damaged, const fs::path& whole) {
  std::error_code error;
  uintmax_t bytes = fs::file_size(damaged, error);
  if (error) {
    throw InputError(damaged, {}, "cannot be read: " + error.message(),
                     "Name a map that `adit run` has made");
  }
  const uintmax_t log = fs::file_size(damaged.string() + "-wal", error);
  bytes += error ? 0 : log;
  require_no_writer(damaged);
  const UnfinishedMap unfinished(whole);
  try {
    MapRecovery done = recover(damaged, unfinished);
    unfinished.take_its_place();
    return done;
  } catch (const OutputError& failure) {
    constexpr uintmax_t kMebibyte = 1024 * 1024;
    throw OutputError(failure.file(),
                      std::string(failure.what()) + " While it is being made, " + whole.string() +
                          " needs up to " + std::to_string(2 * bytes / kMebibyte + 1) +
                          " MiB on its disk: make room there, or name another place with -o. "
                          "Nothing is left of the attempt.");
  }
}

}  // namespace adit
