// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "tools/demo_drive.hpp"

namespace adit {

/// The files of a simulated recording.
struct DemoFiles {
  explicit DemoFiles(const std::filesystem::path& folder);

  std::filesystem::path recording;  ///< a folder as KITTI lays it out
  std::filesystem::path truth;      ///< TUM, in the frame of the first sweep
};

/// Simulates every sweep of the drive and writes them with their times and the truth. The same
/// arguments give the same bytes. Sweeps that a longer recording left in the folder are removed.
/// `progress(done)` is called after each sweep. Throws OutputError.
DemoFiles write_demo_recording(const std::filesystem::path& folder, const DemoDrive& drive,
                               const SpinningLidar& lidar,
                               const std::function<void(std::size_t)>& progress = {});

}  // namespace adit
