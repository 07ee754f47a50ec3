// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a raw drive of KITTI holds beside its sweeps: the inertial navigation system, and how the
// sensors are mounted.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "adit/tools/recordings/series_recording.hpp"

namespace adit {

/// The sweeps of a drive together with what was recorded beside them: from DRIVE/oxts
/// (timestamps.txt, data/*.txt) /oxts/imu, body axes x forward, y left, z up; /oxts/fix;
/// /oxts/pose, poses of that body ("imu") in "world", whose axes are east, north and up and whose
/// origin is the first position, by the Mercator projection at its latitude (as the data set's own
/// tools do); the transforms in calib_imu_to_velo.txt and calib_velo_to_cam.txt, beside the drive
/// or in it, between the frames "imu", "velodyne" and "cam0". The sweeps alone where there is
/// nothing, or where nothing tells their times. Throws InputError: times that are none or not as
/// many as files, a calibration that is none.
std::unique_ptr<Recording> with_kitti_raw_series(const std::filesystem::path& drive,
                                                 std::unique_ptr<Recording> sweeps);

/// The thirty numbers of one reading, as dataformat.txt lists them, as an event. Throws
/// SeriesLineError.
ImuSample kitti_imu(Nanoseconds stamp, std::string_view line);
GnssFix kitti_fix(Nanoseconds stamp, std::string_view line);

}  // namespace adit
