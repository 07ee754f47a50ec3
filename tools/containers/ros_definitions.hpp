// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "adit/tools/containers/message_file.hpp"

namespace adit::ros {

/// What a container tells about a type, so that programs which never heard of it can read it.
struct Definition {
  std::string text;  ///< its fields, then those of the types in it, separated as ROS does
  std::string md5;   ///< ROS 1 only
};

/// Definition of a known type ("sensor_msgs/Imu"), for ROS 1 or ROS 2; nothing for others.
std::optional<Definition> definition_of(std::string_view type, Encoding encoding);

}  // namespace adit::ros
