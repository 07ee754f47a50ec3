// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The topics of a recording on which a camera's images are.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/cameras/message_images.hpp"
#include "adit/tools/cameras/message_pixels.hpp"
#include "adit/tools/recordings/ros_messages.hpp"

namespace adit {

/// A topic of images.
struct CameraTopic {
  std::string name;
  ros::PixelKind pixels = ros::PixelKind::none;  ///< by its first image
  bool packed = false;                           ///< JPEG or PNG
  std::string frame;                             ///< of its first image's header
  std::string problem{};                         ///< why its images are not read; empty: they are
};

/// The topics with images, in the order of the files and their channels, by their first image that
/// can be read.
std::vector<CameraTopic> list_camera_topics(const std::vector<std::unique_ptr<MessageFile>>& files);

/// The one of that name, or of that name with "/compressed"; null where there is none.
const CameraTopic* find_camera_topic(const std::vector<CameraTopic>& topics, std::string_view name);

}  // namespace adit
