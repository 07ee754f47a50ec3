// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/message_cameras.hpp"

#include <optional>
#include <string>
#include <string_view>

#include "adit/tools/recordings/ros_images.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit {
namespace {

/// take(message) with the first message of a channel that can be read and decoded.
template <class Message, class Take>
void with_first(const MessageFile& file, std::size_t channel, Take&& take) {
  try {
    const auto stream = file.messages({.channels = {channel}, .by_index = true});
    if (const std::optional<RawMessage> raw = stream->next()) {
      take(ros::decode<Message>(file.channels()[channel].encoding, raw->bytes));
    }
  } catch (const InputError&) {
    // reported where the messages are read
  } catch (const ros::CodecError&) {
    // likewise
  }
}

}  // namespace

std::string_view without_transport(std::string_view images) {
  constexpr std::string_view kTransport = "/compressed";
  if (images.ends_with(kTransport)) {
    images.remove_suffix(kTransport.size());
  }
  return images;
}

std::string camera_info_topic(std::string_view images) {
  const std::string_view plain = without_transport(images);
  return std::string(plain.substr(0, plain.rfind('/') + 1)) + "camera_info";
}

bool is_rectified(std::string_view images) {
  const std::string_view plain = without_transport(images);
  return plain.find("rect", plain.rfind('/') + 1) != std::string_view::npos;
}

std::optional<ros::CameraInfo> find_camera_info(const std::vector<const MessageFile*>& files,
                                                std::string_view topic) {
  std::optional<ros::CameraInfo> found;
  for (const MessageFile* file : files) {
    for (std::size_t i = 0; i < file->channels().size() && !found; ++i) {
      const Channel& channel = file->channels()[i];
      if (channel.topic == topic && channel.type == ros::CameraInfo::kType) {
        with_first<ros::CameraInfo>(*file, i, [&](const ros::CameraInfo& info) { found = info; });
      }
    }
  }
  return found;
}

std::unique_ptr<DepthCamera> find_depth_camera(const MessageFile& file, std::size_t channel,
                                               const std::vector<const MessageFile*>& files) {
  const std::string& topic = file.channels()[channel].topic;
  const std::optional<ros::CameraInfo> info = find_camera_info(files, camera_info_topic(topic));
  std::optional<CameraModel> model;
  try {
    model = info ? std::optional(ros::to_camera(*info, is_rectified(topic))) : std::nullopt;
  } catch (const ros::CodecError&) {
    return nullptr;  // not calibrated
  }
  std::unique_ptr<DepthCamera> camera;
  if (model) {
    with_first<ros::Image>(file, channel, [&](const ros::Image& image) {
      if (ros::is_whole_depth(image) && image.width == model->width &&
          image.height == model->height) {
        camera = std::make_unique<DepthCamera>(*model);
      }
    });
  }
  return camera;
}

}  // namespace adit
