// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The images in the messages of a recording.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "adit/tools/cameras/camera_source.hpp"
#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// The containers of a recording, which stay open for as long as its images are read.
using SharedMessageFiles = std::shared_ptr<const std::vector<std::unique_ptr<MessageFile>>>;

/// Messages of images: sensor_msgs/Image or sensor_msgs/CompressedImage, in an encoding that is
/// known.
bool has_images(const Channel& channel);

/// The images on each of the topics, by the stamps of their headers (of a header without one: when
/// it was received). The recording is read once, without decoding a pixel. Damaged messages are
/// left out; adit reports them where it reads the recording. The series may be used by several
/// threads.
std::vector<std::shared_ptr<const ImageSeries>> read_message_images(
    const SharedMessageFiles& files, const std::vector<std::string>& topics);

}  // namespace adit
