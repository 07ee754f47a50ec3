// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Small recordings of cameras.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/tests/recordings/sequence_support.hpp"
#include "adit/tests/support/color_images.hpp"
#include "adit/tests/support/temporary_folder.hpp"

namespace adit::test {

inline ros::CameraInfo color_camera_info(uint32_t width, uint32_t height) {
  ros::CameraInfo info = camera_info_message(0);
  info.header.frame = "camera_optical_frame";
  info.width = width;
  info.height = height;
  info.d = {0.1, -0.05, 0.001, -0.002, 0.0};
  return info;
}

/// Writes recordings with topics of a test's choice.
class CameraRecorder {
 public:
  CameraRecorder(const TemporaryFolder& folder, const std::string& name, Container container,
                 std::size_t chunk_bytes = 2000)
      : encoding_(encoding_of(container)),
        path_(folder / (name + (container == Container::rosbag2 ? ""
                                : container == Container::bag   ? ".bag"
                                                                : ".mcap"))) {
    if (container == Container::bag) {
      writer_ = std::make_unique<BagWriter>(
          path_, BagOptions{.compression = Compression::lz4, .chunk_bytes = chunk_bytes});
    } else if (container == Container::rosbag2) {
      writer_ = std::make_unique<Rosbag2Writer>(path_, Rosbag2Options{});
    } else {
      writer_ = std::make_unique<McapWriter>(
          path_,
          McapOptions{.chunks = container != Container::mcap_no_chunks,
                      .chunk_bytes = container == Container::mcap_one_chunk ? std::size_t{1} << 24U
                                                                            : chunk_bytes,
                      .summary = container != Container::mcap_no_summary &&
                                 container != Container::mcap_no_chunks});
    }
  }

  template <class Message>
  void write(const std::string& topic, Nanoseconds received, const Message& message) {
    std::size_t place = 0;
    while (place < topics_.size() && topics_[place] != topic) {
      ++place;
    }
    if (place == topics_.size()) {
      topics_.push_back(topic);
      channels_.push_back(writer_->add_channel(
          {.topic = topic,
           .type = std::string(Message::kType),
           .encoding = encoding_,
           .definition = ros::definition_of(Message::kType, encoding_).value().text,
           .messages = std::nullopt}));
    }
    writer_->write(channels_[place], received, ros::encode(encoding_, message));
  }

  /// A picture of one shade, 8 x 6, as rgb8 unless `encoding` says otherwise (of 3 bytes a pixel).
  void write_image(const std::string& topic, Nanoseconds received, Nanoseconds stamp,
                   unsigned shade, const std::string& encoding = "rgb8") {
    const ColorImage picture = color_picture(8, 6, shade);
    ros::Image image;
    image.header = {.sequence = 0, .stamp = stamp, .frame = "camera_optical_frame"};
    image.width = 8;
    image.height = 6;
    image.encoding = encoding;
    image.step = 24;
    image.data = std::as_bytes(std::span(picture.rgb));
    write(topic, received, image);
  }

  void write_jpeg(const std::string& topic, Nanoseconds received, Nanoseconds stamp, unsigned shade,
                  bool grey = false) {
    const std::string bytes =
        jpeg_bytes(color_picture(8, 6, shade), grey ? TJSAMP_GRAY : TJSAMP_444);
    ros::CompressedImage image;
    image.header = {.sequence = 0, .stamp = stamp, .frame = "jpeg_frame"};
    image.format = "rgb8; jpeg compressed bgr8";
    image.data = std::as_bytes(std::span(bytes));
    write(topic, received, image);
  }

  std::filesystem::path close() {
    writer_->close();
    return path_;
  }

 private:
  Encoding encoding_;
  std::filesystem::path path_;
  std::unique_ptr<MessageWriter> writer_;
  std::vector<std::string> topics_;
  std::vector<std::size_t> channels_;
};

}  // namespace adit::test
