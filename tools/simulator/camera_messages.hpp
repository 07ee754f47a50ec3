// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adit/slam/core/camera_model.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/simulator/camera_simulator.hpp"

namespace adit {

/// sensor_msgs/Image, rgb8, as the driver of a camera publishes it; the image's stamp is the
/// message's.
ros::EncodedEvent image_message(const SimulatedImage& image, const std::string& frame);

/// sensor_msgs/CameraInfo of an image: plumb_bob, or equidistant for a fisheye.
ros::EncodedEvent camera_info_message(const CameraModel& camera, Nanoseconds stamp,
                                      const std::string& frame);

}  // namespace adit
