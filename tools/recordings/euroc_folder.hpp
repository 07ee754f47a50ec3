// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// True for a folder in the layout of EuRoC (ASL format): FOLDER/mav0/imu0/data.csv, or the same
/// without mav0.
bool is_euroc_folder(const std::filesystem::path& folder);

/// Opens the IMUs (imu*/data.csv: ns, rad/s, m/s²) and the poses (state_groundtruth_estimate*,
/// vicon*, mocap*: ns, m, unit quaternion w x y z) of such a folder; images are not read. Events
/// come in the order of their times. Throws InputError where a file cannot be read.
std::unique_ptr<Recording> open_euroc_folder(const std::filesystem::path& folder);

}  // namespace adit
