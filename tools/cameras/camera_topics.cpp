// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/cameras/camera_topics.hpp"

#include <algorithm>

#include "adit/tools/cameras/image_codec.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit {
namespace {

/// A JPEG or PNG without colours: each pixel has three equal ones.
bool is_grey(const ColorImage& image) {
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    if (image.rgb[i] != image.rgb[i + 1] || image.rgb[i] != image.rgb[i + 2]) {
      return false;
    }
  }
  return true;
}

void look_at(CameraTopic& topic, const ros::Image& image) {
  topic.frame = image.header.frame;
  topic.pixels = ros::kind_of_pixels(image.encoding);
  if (topic.pixels == ros::PixelKind::none) {
    topic.problem = "its images of the encoding '" + image.encoding + "' are not read as colours";
  }
}

void look_at(CameraTopic& topic, const ros::CompressedImage& image) {
  topic.frame = image.header.frame;
  topic.packed = true;
  if (ros::is_depth(image)) {
    topic.problem = "its images are depths";
    return;
  }
  try {
    topic.pixels = is_grey(ros::to_color(image)) ? ros::PixelKind::grey : ros::PixelKind::colors;
  } catch (const ImageError& error) {
    topic.problem = std::string("its first image cannot be read: ") + error.what();
  }
}

/// True once the topic is known by an image of the channel.
bool look_at_first(CameraTopic& topic, const MessageFile& file, std::size_t channel) {
  try {
    const auto stream = file.messages({.channels = {channel}, .by_index = true});
    if (const std::optional<RawMessage> raw = stream->next()) {
      const Channel& of = file.channels()[channel];
      topic.problem.clear();
      if (of.type == ros::Image::kType) {
        look_at(topic, ros::decode<ros::Image>(of.encoding, raw->bytes));
      } else {
        look_at(topic, ros::decode<ros::CompressedImage>(of.encoding, raw->bytes));
      }
      return true;
    }
  } catch (const InputError& error) {
    topic.problem = "its first image cannot be read: " + error.found();
  } catch (const ros::CodecError& error) {
    topic.problem = std::string("its first image cannot be read: ") + error.what();
  }
  return false;
}

}  // namespace

std::vector<CameraTopic> list_camera_topics(
    const std::vector<std::unique_ptr<MessageFile>>& files) {
  std::vector<CameraTopic> topics;
  std::vector<bool> known;
  for (const std::unique_ptr<MessageFile>& file : files) {
    for (std::size_t i = 0; i < file->channels().size(); ++i) {
      if (!has_images(file->channels()[i])) {
        continue;
      }
      const std::string& name = file->channels()[i].topic;
      const auto place = static_cast<std::size_t>(
          std::ranges::find(topics, name, &CameraTopic::name) - topics.begin());
      if (place == topics.size()) {
        topics.push_back({.name = name, .frame = {}, .problem = "it has no images"});
        known.push_back(false);
      }
      known[place] = known[place] || look_at_first(topics[place], *file, i);
    }
  }
  return topics;
}

const CameraTopic* find_camera_topic(const std::vector<CameraTopic>& topics,
                                     std::string_view name) {
  for (const std::string& wanted : {std::string(name), std::string(name) + "/compressed"}) {
    const auto found = std::ranges::find(topics, wanted, &CameraTopic::name);
    if (found != topics.end()) {
      return &*found;
    }
  }
  return nullptr;
}

}  // namespace adit
