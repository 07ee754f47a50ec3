// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/found_space.hpp"

#include <optional>
#include <utility>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/map_products/moved_space_map.hpp"
#include "adit/tools/support/progress.hpp"

namespace adit {

std::shared_ptr<const MovedSpace> find_moving(const ExportJob& job, std::ostream& out) {
  DeviceOptions wanted = job.options->device;
  wanted.notes = job.err;
  DeviceSession device(wanted);
  std::optional<Progress> progress;
  MovedSpace moved =
      find_moved_space(*job.map, device.context(), job.memory->submap_bytes(),
                       [&](std::size_t done, std::size_t total) {
                         if (!progress) {
                           progress.emplace(*job.err, progress_style_of_stderr(), "moving", total,
                                            Progress::Clock::now(), "tiles");
                         }
                         progress->update(done, 0);
                         require_within(job);
                       });
  if (progress) {
    progress->finish();
  }
  device.require_no_complaints();
  out << fmt::format("moving {} voxels of {} m hold what other submaps saw through\n",
                     moved.voxels(), shortest(moved.edge()));
  return std::make_shared<const MovedSpace>(std::move(moved));
}

std::shared_ptr<const GoneSpace> find_gone(const ExportJob& job, std::ostream& out) {
  std::optional<Progress> progress;
  const auto until =
      job.options->until ? std::optional(nanoseconds(*job.options->until)) : std::nullopt;
  auto gone = std::make_shared<const GoneSpace>(
      gone_space(job.map->file(), until, [&](const ChangesStep& step) {
        if (!progress) {
          progress.emplace(*job.err, progress_style_of_stderr(), "comparing", step.total,
                           Progress::Clock::now(), "tiles");
        }
        progress->update(step.done, 0);
        require_within(job);
        return true;
      }));
  if (progress) {
    progress->finish();
  }
  out << fmt::format("gone   {} voxels of {} m hold what later sessions saw through\n",
                     gone->voxels(), shortest(gone->edge()));
  return gone;
}

}  // namespace adit
