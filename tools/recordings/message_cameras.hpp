// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "adit/tools/clouds/depth_camera.hpp"
#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// The camera whose depth images are on a channel of a file: known by the channel's first image
/// (16UC1 or 32FC1) and the first sensor_msgs/CameraInfo on camera_info beside the images' topic,
/// in whichever of the recording's files. Images on a topic with "rect" in its name count as
/// rectified. Null where the images are no depths, or where no calibration that makes sense is
/// there.
std::unique_ptr<DepthCamera> find_depth_camera(const MessageFile& file, std::size_t channel,
                                               const std::vector<const MessageFile*>& files);

}  // namespace adit
