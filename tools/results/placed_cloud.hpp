// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "adit/slam/core/types.hpp"

namespace adit {

/// A sweep's points in a cloud that was written as sweeps came: where they lie was known only as
/// well as it was then.
struct CloudPart {
  Nanoseconds stamp{0};
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();  ///< that they were placed with
  uint64_t points = 0;
};

/// Writes the cloud of a PlyWriter anew, as a whole or not at all, each part where its sweep is in
/// `poses`; one whose sweep is not among them stays. Memory holds one part. Throws OutputError,
/// also where the file is not what `parts` says.
void place_again(const std::filesystem::path& ply, std::span<const CloudPart> parts,
                 std::span<const StampedPose> poses);

}  // namespace adit
