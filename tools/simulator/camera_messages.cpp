// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/camera_messages.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_messages.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit {

ros::EncodedEvent image_message(const SimulatedImage& image, const std::string& frame) {
  ros::Image message;
  message.header = {.sequence = 0, .stamp = image.stamp, .frame = frame};
  message.height = static_cast<uint32_t>(image.image.height);
  message.width = static_cast<uint32_t>(image.image.width);
  message.encoding = "rgb8";
  message.step = 3 * message.width;
  message.data = std::as_bytes(std::span(image.image.rgb));
  return {std::string(message.kType), ros::encode(Encoding::cdr, message)};
}

ros::EncodedEvent camera_info_message(const CameraModel& camera, Nanoseconds stamp,
                                      const std::string& frame) {
  constexpr std::ptrdiff_t kOfPlumbBob = 5;
  constexpr std::ptrdiff_t kOfEquidistant = 4;
  const bool fisheye = camera.lens == Lens::fisheye;
  ros::CameraInfo message;
  message.header = {.sequence = 0, .stamp = stamp, .frame = frame};
  message.height = static_cast<uint32_t>(camera.height);
  message.width = static_cast<uint32_t>(camera.width);
  message.distortion_model = fisheye ? "equidistant" : "plumb_bob";
  message.d.assign(camera.distortion.begin(),
                   camera.distortion.begin() + (fisheye ? kOfEquidistant : kOfPlumbBob));
  message.k = {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
  message.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  message.p = {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return {std::string(message.kType), ros::encode(Encoding::cdr, message)};
}

}  // namespace adit
