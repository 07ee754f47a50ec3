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
    const auto stream = file.messages({.channels = {channel}});
    if (const std::optional<RawMessage> raw = stream->next()) {
      take(ros::decode<Message>(file.channels()[channel].encoding, raw->bytes));
    }
  } catch (const InputError&) {
    // reported where the messages are read
  } catch (const ros::CodecError&) {
    // likewise
  }
}

std::optional<CameraModel> find_model(const std::vector<const MessageFile*>& files,
                                      std::string_view topic, bool rectified) {
  std::optional<CameraModel> model;
  for (const MessageFile* file : files) {
    for (std::size_t i = 0; i < file->channels().size() && !model; ++i) {
      const Channel& channel = file->channels()[i];
      if (channel.topic == topic && channel.type == ros::CameraInfo::kType) {
        with_first<ros::CameraInfo>(*file, i, [&](const ros::CameraInfo& info) {
          model = ros::to_camera(info, rectified);
        });
      }
    }
  }
  return model;
}

}  // namespace

std::unique_ptr<DepthCamera> find_depth_camera(const MessageFile& file, std::size_t channel,
                                               const std::vector<const MessageFile*>& files) {
  const std::string& topic = file.channels()[channel].topic;
  const std::string space = topic.substr(0, topic.rfind('/') + 1);
  const bool rectified = topic.find("rect", space.size()) != std::string::npos;
  const std::optional<CameraModel> model = find_model(files, space + "camera_info", rectified);
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
