// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// True for a folder in the layout of TUM RGB-D: FOLDER/depth.txt, which names the depth images.
bool is_tum_folder(const std::filesystem::path& folder);

/// Opens the depth images of such a folder as sweeps (PNG, 16 bits, 5000 a metre), groundtruth.txt
/// as poses (time tx ty tz qx qy qz qw) and accelerometer.txt as IMU samples without angular
/// velocities (NaN); colour images are not read. Points are in the camera's optical frame. Its
/// focal lengths and centre come from calibration.txt (fx fy cx cy, as ETH3D writes it), else they
/// are ROS's defaults, which the data set recommends (525 525 319.5 239.5), and 640 x 480 pixels.
/// Throws InputError where a file cannot be read or calibration.txt makes no sense.
std::unique_ptr<Recording> open_tum_folder(const std::filesystem::path& folder);

}  // namespace adit
