// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/clouds/depth_camera.hpp"
#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/recordings/ros_messages.hpp"

namespace adit {

/// The topic of images without what image_transport appends to it: "/compressed".
std::string_view without_transport(std::string_view images);

/// The topic of the calibration that belongs to one of images: camera_info in its namespace.
std::string camera_info_topic(std::string_view images);

/// True for images that count as rectified: with "rect" in the last part of the topic's name.
bool is_rectified(std::string_view images);

/// The first sensor_msgs/CameraInfo on a topic that can be read, in whichever of the files.
std::optional<ros::CameraInfo> find_camera_info(const std::vector<const MessageFile*>& files,
                                                std::string_view topic);

/// The camera whose depth images are on a channel of a file: known by the channel's first image
/// (16UC1 or 32FC1) and the first sensor_msgs/CameraInfo on camera_info beside the images' topic,
/// in whichever of the recording's files. Images on a topic with "rect" in its name count as
/// rectified. Null where the images are no depths, or where no calibration that makes sense is
/// there.
std::unique_ptr<DepthCamera> find_depth_camera(const MessageFile& file, std::size_t channel,
                                               const std::vector<const MessageFile*>& files);

}  // namespace adit
