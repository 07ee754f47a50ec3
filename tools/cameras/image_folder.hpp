// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "adit/tools/cameras/camera_source.hpp"

namespace adit {

/// The JPEG and PNG files (by their names: .jpg, .jpeg, .png) in a folder, in the order of their
/// times. These come from timestamps.txt or times.txt in the folder, or beside a folder called
/// "data" (one time a line, in the order of the names; see read_times()), else from the names
/// (see time_from_name()): seconds with a fraction, or 19 digits of nanoseconds. Throws InputError:
/// no such folder, no image in it, no times, or not as many as images.
std::shared_ptr<const ImageSeries> open_image_folder(const std::filesystem::path& folder);

}  // namespace adit
