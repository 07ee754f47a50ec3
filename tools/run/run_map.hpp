// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The map of a run, OUT/map.adit.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "adit/tools/map_database/continued_map.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/session_over_map.hpp"
#include "adit/tools/report/run_summary.hpp"
#include "adit/tools/results/placed_cloud.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/run/map_use.hpp"

namespace adit {

/// Throws LockedError where another process writes to the folder's map.
void require_free_map(const std::filesystem::path& folder);

/// A map that a run fills.
class RunMap {
 public:
  /// Nothing of an earlier one may be left in its place.
  RunMap(const RunDescription& run, const MapSession& session);
  /// Goes on with the map of an earlier run. Throws InputError where it cannot.
  RunMap(const RunDescription& run, const MapSession& session, const EarlierRun& earlier);
  /// Extends a copy of an earlier map, or is localised in it. Throws InputError where it cannot.
  RunMap(const RunDescription& run, const MapSession& session, const MapUse& use);
  RunMap(const RunMap&) = delete;
  RunMap& operator=(const RunMap&) = delete;

  MapStore& store() {
    return continued_ ? static_cast<MapStore&>(*continued_)
           : over_    ? static_cast<MapStore&>(*over_)
                      : database_;
  }
  SessionId session() const { return session_; }
  /// The recording was mapped to its end: there is nothing left to go on with.
  void set_complete() { database_.set_complete(session_); }
  /// trajectory.tum and trajectory.kitti of the final map, in place of what was known as the run
  /// went on, which online.tum keeps; and the parts of map.ply where the final map has them. Throws
  /// OutputError.
  void write_final(std::span<const CloudPart> parts) const;

 private:
  RunFiles files_;
  std::optional<MapDatabase> earlier_{};  ///< that the run is localised in
  MapDatabase database_;
  SessionId session_;
  std::optional<ContinuedMap> continued_;
  std::optional<SessionOverMap> over_;
};

}  // namespace adit
