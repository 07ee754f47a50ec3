// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where the sessions of a map, or two maps, differ, and what of a map's points is gone since.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "adit/slam/submaps/changed_objects.hpp"
#include "adit/tools/map_changes/compared_maps.hpp"

namespace adit {

/// How far the comparison is: keyframes of a search for common places, then tiles.
struct ChangesStep {
  std::size_t done = 0;
  std::size_t total = 0;  ///< 0: not known
};

struct ChangedSpace {
  double edge = 0.0;                                ///< m, of a voxel
  std::vector<ChangedVoxel> voxels{};               ///< common frame
  std::vector<std::vector<std::size_t>> objects{};  ///< as of changed_objects()
  std::size_t points = 0;                           ///< that were compared
};

/// False from `on_step` ends it with MergeStopped. Throws InputError where a map is damaged.
ChangedSpace changed_space(const ComparedMaps& maps,
                           const std::function<bool(const ChangesStep&)>& on_step);

/// Where surfaces of a map's earlier sessions are gone.
class GoneSpace {
 public:
  /// By what sessions show that begin at `until` or before; nothing: by all of them.
  GoneSpace(const ComparedMaps& maps, const ChangedSpace& space, std::optional<Nanoseconds> until);

  /// The session's point (m, map) is of something that a later session saw to be gone.
  bool has(const Eigen::Vector3d& point, SessionId session) const;
  std::size_t voxels() const { return last_.size(); }
  double edge() const { return edge_; }  ///< m, of a voxel

 private:
  using Index = std::array<int64_t, 3>;

  double edge_;
  std::map<Index, uint32_t> last_;  ///< period that had it last
  std::map<SessionId, uint32_t> periods_;
};

/// Of a map with several sessions. Throws as compared_maps() does, and MergeStopped.
GoneSpace gone_space(const std::filesystem::path& map, std::optional<Nanoseconds> until,
                     const std::function<bool(const ChangesStep&)>& on_step);

}  // namespace adit
