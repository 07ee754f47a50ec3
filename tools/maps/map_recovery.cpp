// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/maps/map_recovery.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "adit/slam/mapping/submap_codec.hpp"
#include "adit/tools/containers/sqlite_database.hpp"
#include "adit/tools/maps/map_database.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

// Rows that are looked for one by one: between those that are seen, and where none is.
constexpr int64_t kMostHidden = 1'000'000;
constexpr int64_t kBeyond = 10'000;

/// Ids of a table as they are read in one order, up to the first page that is damaged.
struct IdsInOrder {
  std::vector<int64_t> ids;
  bool all = false;
};

IdsInOrder ids_in_order(const SqliteDatabase& database, const std::string& table,
                        const std::string& order) {
  IdsInOrder read;
  try {
    SqliteStatement rows = database.prepare("SELECT id FROM " + table + " ORDER BY id " + order);
    while (rows.step()) {
      read.ids.push_back(rows.integer(0));
    }
    read.all = true;
  } catch (const FileError&) {
    read.all = false;
  }
  return read;
}

/// Every id that a row of the table may have: those that are seen from either end, and those
/// between them, which damaged pages hide.
std::set<int64_t> possible_ids(const SqliteDatabase& database, const std::string& table) {
  const IdsInOrder first = ids_in_order(database, table, "ASC");
  std::set<int64_t> ids(first.ids.begin(), first.ids.end());
  if (!first.all) {
    const std::vector<int64_t> last = ids_in_order(database, table, "DESC").ids;
    ids.insert(last.begin(), last.end());
    const int64_t from = first.ids.empty() ? 0 : first.ids.back() + 1;
    const int64_t to = last.empty() ? from + kBeyond : last.back();
    for (int64_t id = from; id < std::min(to, from + kMostHidden); ++id) {
      ids.insert(id);
    }
  }
  return ids;
}

class Recovery {
 public:
  Recovery(const fs::path& damaged, const fs::path& whole)
      : source_(damaged, MapAccess::read),
        rows_(damaged, SqliteDatabase::Mode::read),
        target_(whole, MapAccess::write) {}

  MapRecovery run() {
    each("sessions", [&](int64_t id) { take_session(id); });
    done_.lost_keyframes = each("keyframes", [&](int64_t id) { take_keyframe(id); });
    done_.lost_edges = each("edges", [&](int64_t id) { take_edge(id); });
    each("candidates", [&](int64_t id) { take_candidate(id); });
    each("fixes", [&](int64_t id) { take_fix(id); });
    try {
      target_.revise({.georeference = source_.georeference()});
    } catch (const InputError& error) {
      done_.problems.push_back("the map's place in the world: " + error.found());
    }
    return std::move(done_);
  }

 private:
  /// Calls take(id) for each id that may be one; returns how many rows could not be read.
  std::size_t each(const std::string& table, const std::function<void(int64_t)>& take) {
    std::size_t lost = 0;
    for (const int64_t id : possible_ids(rows_, table)) {
      try {
        take(id);
      } catch (const InputError& error) {
        ++lost;
        done_.problems.push_back(table + ", number " + std::to_string(id) + ": " + error.found());
      } catch (const SubmapDamaged& damage) {
        ++lost;
        done_.problems.push_back(table + ", number " + std::to_string(id) + ": its submap " +
                                 damage.what());
      } catch (const GraphError& error) {
        ++lost;
        done_.problems.push_back(table + ", number " + std::to_string(id) + ": " + error.what());
      }
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
    return sessions_[old] = target_.add_session({.name = "recovered"});
  }

  void take_keyframe(int64_t id) {
    std::optional<MapKeyframe> keyframe = source_.keyframe(id);
    if (!keyframe) {
      return;
    }
    KeyframeRecord record{.keyframe = *keyframe, .submap = source_.submap(id)};
    static_cast<void>(decode(record.submap));  // throws where it is none
    PoseGraph().add_node({.id = id, .T_map_node = keyframe->T_map_keyframe});  // as does this
    record.keyframe.session = session_of(keyframe->session);
    target_.store(record);
    keyframes_.insert(id);
    ++done_.keyframes;
  }

  void take_edge(int64_t id) {
    const std::optional<PoseEdge> edge = source_.edge(id);
    if (edge && keyframes_.contains(edge->from) && keyframes_.contains(edge->to)) {
      PoseGraph ends;  // which refuses an edge that no graph may have
      ends.add_node({.id = edge->from});
      ends.add_node({.id = edge->to});
      ends.add_edge(*edge);
      target_.revise({.edges = {*edge}});
      ++done_.edges;
    }
  }

  void take_candidate(int64_t id) {
    const std::optional<LoopCandidate> candidate = source_.candidate(id);
    if (candidate && keyframes_.contains(candidate->from) && keyframes_.contains(candidate->to)) {
      target_.revise({.candidates = {*candidate}});
      ++done_.candidates;
    }
  }

  void take_fix(int64_t id) {
    const std::optional<MapFix> fix = source_.fix(id);
    if (fix && keyframes_.contains(fix->keyframe)) {
      target_.revise({.fixes = {*fix}});
    }
  }

  MapDatabase source_;
  SqliteDatabase rows_;
  MapDatabase target_;
  MapRecovery done_;
  std::map<SessionId, SessionId> sessions_;  ///< old to new
  std::set<NodeId> keyframes_;               ///< that are in the new map
};

}  // namespace

MapRecovery recover_map(const fs::path& damaged, const fs::path& whole) {
  return Recovery(damaged, whole).run();
}

}  // namespace adit
