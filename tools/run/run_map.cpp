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

void RunMap::write_final(std::span<const CloudPart> parts) const {
  std::error_code error;
  fs::copy_file(files_.tum, files_.online, fs::copy_options::overwrite_existing, error);
  if (error) {
    throw OutputError(files_.online,
                      files_.online.string() + ": cannot be written: " + error.message() + ".");
  }
  const std::vector<StampedPose> poses = map_trajectory(database_, files_.database);
  const std::vector<std::size_t> apart = map_parts(database_, files_.database);
  replace_trajectory(files_.tum, TrajectoryFormat::tum, poses, apart);
  replace_trajectory(files_.kitti, TrajectoryFormat::kitti, poses, apart);
  if (!parts.empty()) {
    place_again(files_.map, parts, poses);
  }
}

}  // namespace adit
