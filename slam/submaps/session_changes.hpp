// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is different between sessions of a map: surfaces of one session where another session's rays
// pass (docs/theory/changes.md). moved_space.hpp finds what moves within a session.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/submaps/moved_space.hpp"

namespace adit {

/// A submap of a session. Sessions are numbered in the order of time.
struct SessionSubmap {
  PlacedSubmap placed{};
  uint32_t session = 0;
};

enum class ChangeOfSpace {
  gone,     ///< a surface that later sessions see through
  appeared  ///< a surface in space that earlier sessions saw through
};

/// A voxel with a surface that one session has and others do not.
struct ChangedVoxel {
  VoxelIndex voxel = VoxelIndex::Zero();
  ChangeOfSpace change = ChangeOfSpace::gone;
  uint32_t session = 0;   ///< that has the surface
  uint32_t other = 0;     ///< nearest in time of those that see through it
  uint32_t through = 0;   ///< submaps of other sessions that see through it
  double log_odds = 0.0;  ///< that it has changed, against that it has not, from counts alone
  std::vector<Eigen::Vector3d> points{};  ///< of that session in the voxel, map frame, m
};

struct ChangesOfTile {
  std::vector<ChangedVoxel> voxels{};  ///< in the order of their indices
  std::size_t points = 0;              ///< of all sessions in the tile
};

/// Compares the sessions in a tile; voxels have this edge (m). `submap` gives each of the submaps
/// that reach into it, five times, in their order. Voxels whose log odds are below `least` are left
/// out, and those that fewer than two submaps see through.
ChangesOfTile changes_in_tile(const SpaceTile& tile, double edge, std::size_t submaps,
                              const std::function<SessionSubmap(std::size_t)>& submap,
                              double least);

/// Log odds that a surface has changed. Of the submaps of its own session that look at it,
/// `own_hits` see it and `own_through` see through it; of the other sessions' `hits` and `through`.
double change_log_odds(uint32_t own_hits, uint32_t own_through, uint32_t hits, uint32_t through);

}  // namespace adit
