// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The map of a run, OUT/map.adit.
#pragma once

#include <filesystem>

#include "adit/tools/maps/map_database.hpp"
#include "adit/tools/run/run_summary.hpp"

namespace adit {

/// Throws LockedError where another process writes to the folder's map.
void require_free_map(const std::filesystem::path& folder);

/// A map that a run fills. Nothing of an earlier one may be left in its place.
class RunMap {
 public:
  explicit RunMap(const RunDescription& run);

  MapStore& store() { return database_; }
  SessionId session() const { return session_; }
  /// trajectory.tum and trajectory.kitti of the final map, in place of what was known as the run
  /// went on, which online.tum keeps. Throws OutputError.
  void write_trajectory() const;

 private:
  RunFiles files_;
  MapDatabase database_;
  SessionId session_;
};

}  // namespace adit
