// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A recording is a sequence of sweeps in files. See open_recording() for the layouts that are
// recognised.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "slam/types.hpp"
#include "tools/input_error.hpp"

namespace adit {

/// Sweeps in the order of their time.
class Recording {
 public:
  Recording() = default;
  virtual ~Recording() = default;
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// Number of sweeps; at least one.
  virtual std::size_t size() const = 0;

  /// Reads sweep `index` < size(). Throws InputError if its file is damaged; the recording stays
  /// usable, so a caller can report the sweep and read the others, or stop and keep what it has.
  virtual Sweep read(std::size_t index) = 0;

  /// For people, one line: what was recognised, how many sweeps, where their times come from.
  virtual std::string description() const = 0;

  /// True where nothing in the recording tells the times and 10 Hz was assumed (description() says
  /// so too).
  virtual bool times_are_assumed() const = 0;
};

/// Opens a recording. Only names and times are read; the sweeps are read one at a time by
/// Recording::read().
///
/// - KITTI: FOLDER/velodyne/*.bin with FOLDER/times.txt (odometry sequences have the same layout);
///   FOLDER/velodyne_points/data/*.bin with FOLDER/velodyne_points/timestamps.txt (raw); a folder
///   of .bin.
/// - A folder of .pcd or of .ply files, in numeric order of their names. Times come from times.txt
/// or
///   timestamps.txt in the folder, else from the names (seconds with a fraction,
///   SECONDS_NANOSECONDS, micro- or nanoseconds). A per-point time field refines or, where
///   absolute, replaces them.
/// - One .bin, .pcd or .ply file: one sweep.
///
/// Where there are no times, 10 Hz is assumed. Throws InputError: nothing there or nothing readable
/// in it, or times that do not match the files, do not increase, or cannot be read.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path);

}  // namespace adit
