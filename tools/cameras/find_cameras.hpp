// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/tools/cameras/camera_source.hpp"

namespace adit {

/// Which cameras are used, and where their calibration is.
struct CameraChoice {
  std::vector<std::string> topics{};    ///< of images; empty: all
  std::filesystem::path calibration{};  ///< a file of cameras; empty: the recording's CameraInfo
};

/// The cameras of a recording, which may be in several files.
///
/// Without a file of cameras: those whose images (sensor_msgs/Image or CompressedImage) have a
/// sensor_msgs/CameraInfo on camera_info in their namespace, raw or rectified (with "rect" in the
/// last part of the topic's name). Of several topics with the same camera_info one is used: that
/// with colours, else not packed, else the first one; cameras without colours are left out where
/// others have them. Topics that are named are used all. A camera's `frame` is that of its images'
/// headers.
///
/// With a file (see read_camera_file()): the cameras that it lists, with images on the topics or in
/// the folders that it names, or on the topic that is named here. Where it has no calibration of
/// the lens, that is the recording's; without a pose, `frame` is that of the images'
/// headers.
///
/// Throws InputError: no camera is found, a topic that is named has no images or no calibration, or
/// the images have another size than their calibration.
std::vector<CameraSource> find_cameras(const std::vector<std::filesystem::path>& recording,
                                       const CameraChoice& choice = {});

}  // namespace adit
