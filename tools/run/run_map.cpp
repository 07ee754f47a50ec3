// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_map.hpp"

#include <string>
#include <system_error>
#include <vector>

#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_database/writer_lock.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// The whole file or none of it.
void replace_trajectory(const fs::path& file, TrajectoryFormat format,
                        const std::vector<StampedPose>& poses,
                        const std::vector<std::size_t>& parts) {
  Draft draft(file);
  write_trajectory(draft.path(), format, poses, parts);
  draft.take_its_place();
}

/// The file, in which the copy of a map that is extended lies.
const fs::path& with_copy(const fs::path& file, const MapUse& use) {
  if (use.extends) {
    MapDatabase(use.map, MapAccess::read).copy_to(file);
  }
  return file;
}

MapSession localized_in(MapSession session, const MapUse& use) {
  session.provenance.emplace_back(kLocalizedIn, fs::absolute(use.map).string());
  return session;
}

}  // namespace

void require_free_map(const fs::path& folder) {
  const fs::path file = RunFiles(folder).database;
  std::error_code unknown;
  if (fs::exists(file, unknown)) {
    const WriterLock lock(file);
  }
}

RunMap::RunMap(const RunDescription& run, const MapSession& session)
    : files_(run.output),
      database_(files_.database, MapAccess::write),
      session_(database_.add_session(session)) {
  database_.begin_run(session_);
}

RunMap::RunMap(const RunDescription& run, const MapSession& session, const EarlierRun& earlier)
    : files_(run.output),
      database_(files_.database, MapAccess::write),
      session_(earlier.session.id) {
  require_same(earlier, session);
  continued_.emplace(database_, session_);
}

RunMap::RunMap(const RunDescription& run, const MapSession& session, const MapUse& use)
    : files_(run.output),
      database_(with_copy(files_.database, use), MapAccess::write),
      session_(database_.add_session(use.extends ? session : localized_in(session, use))) {
  database_.begin_run(session_);
  if (!use.extends) {
    earlier_.emplace(use.map, MapAccess::read);
    over_.emplace(*earlier_, database_);
  }
}

void RunMap::write_final(std::span<const CloudPart> parts) const {
  std::error_code error;
  fs::copy_file(files_.tum, files_.online, fs::copy_options::overwrite_existing, error);
  if (error) {
    throw OutputError(files_.online,
                      files_.online.string() + ": cannot be written: " + error.message() + ".");
  }
  const std::vector<StampedPose> poses = map_trajectory(database_, files_.database, session_);
  const std::vector<std::size_t> apart = map_parts(database_, files_.database, session_);
  replace_trajectory(files_.tum, TrajectoryFormat::tum, poses, apart);
  replace_trajectory(files_.kitti, TrajectoryFormat::kitti, poses, apart);
  if (!parts.empty()) {
    place_again(files_.map, parts, poses);
  }
}

}  // namespace adit
