// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// Opens a recording of one file a sweep. Only names and times are read at first.
///
/// - KITTI: FOLDER/velodyne/*.bin with FOLDER/times.txt (odometry sequences have the same layout);
///   FOLDER/velodyne_points/data/*.bin with FOLDER/velodyne_points/timestamps.txt (raw, with
///   what with_kitti_raw_series() adds); a folder of .bin.
/// - A folder of .pcd, .ply, .las or .laz files, in numeric order of their names. Times come from
///   times.txt or timestamps.txt in the folder, else from the names (seconds with a fraction,
///   SECONDS_NANOSECONDS, micro- or nanoseconds). A per-point time field refines or, where
///   absolute, replaces them.
/// - One .bin, .pcd, .ply, .las or .laz file: one sweep.
///
/// Where there are no times, 10 Hz is assumed. Throws InputError: nothing there or nothing readable
/// in it, or times that do not match the files, do not increase, or cannot be read.
std::unique_ptr<Recording> open_sweep_files(const std::filesystem::path& path);

}  // namespace adit
