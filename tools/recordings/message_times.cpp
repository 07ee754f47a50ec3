// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/message_times.hpp"

#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit {
namespace {

bool begins_with_header(const Channel& channel) {
  switch (ros::kind_of(channel)) {
    case TopicKind::sweeps:
    case TopicKind::imu:
    case TopicKind::gnss:
    case TopicKind::velocities:
    case TopicKind::headings:
    case TopicKind::poses:
      return true;
    case TopicKind::transforms:
    case TopicKind::other:
      break;
  }
  return channel.type == ros::Image::kType || channel.type == ros::CompressedImage::kType;
}

}  // namespace

std::optional<Nanoseconds> stamp_in(const Channel& channel, const RawMessage& message) {
  if (!begins_with_header(channel)) {
    return std::nullopt;
  }
  try {
    ros::Decoder decoder(channel.encoding, message.bytes);
    if (channel.type == ros::TFMessage::kType || channel.type == "tf/tfMessage") {
      uint32_t transforms = 0;
      decoder(transforms);
      if (transforms == 0) {
        return std::nullopt;
      }
    }
    ros::Header header;
    ros::visit(decoder, header);
    return header.stamp == Nanoseconds(0) ? std::nullopt : std::optional(header.stamp);
  } catch (const ros::CodecError&) {
    return std::nullopt;
  }
}

}  // namespace adit
