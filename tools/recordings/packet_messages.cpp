// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/packet_messages.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "adit/tools/packets/packet_capture.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/recordings/ros_visit.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

bool has_packets(const std::vector<std::unique_ptr<MessageFile>>& files) {
  for (const auto& file : files) {
    for (const Channel& channel : file->channels()) {
      if (is_packet_channel(channel)) {
        return true;
      }
    }
  }
  return false;
}

/// What the first message of a topic ".../metadata" says; empty where there is none.
std::string told_metadata(const MessageFile& file) {
  for (std::size_t i = 0; i < file.channels().size(); ++i) {
    const Channel& channel = file.channels()[i];
    if (channel.type != ros::String::kType || !channel.topic.ends_with("metadata") ||
        channel.encoding == Encoding::other) {
      continue;
    }
    try {
      const auto stream = file.messages({.channels = {i}});
      if (const auto message = stream->next()) {
        return ros::decode<ros::String>(channel.encoding, message->bytes).data;
      }
    } catch (const InputError&) {
      // reported where the events are read
    } catch (const ros::CodecError&) {
      // likewise
    }
  }
  return {};
}

}  // namespace

bool is_packet_channel(const Channel& channel) {
  return channel.encoding != Encoding::other && channel.type.starts_with("ouster") &&
         channel.type.ends_with("/PacketMsg");
}

bool holds_packets(const fs::path& recording) {
  std::error_code ignored;
  return (fs::is_regular_file(recording, ignored) && is_packet_capture(recording)) ||
         has_packets(open_message_files(recording));
}

bool is_imu_packet_channel(const Channel& channel) {
  return channel.topic.find("imu") != std::string::npos;
}

std::optional<PacketSensor> packet_sensor_of(const std::vector<std::unique_ptr<MessageFile>>& files,
                                             const fs::path& recording, const fs::path& metadata) {
  if (!has_packets(files)) {
    return std::nullopt;
  }
  if (!metadata.empty()) {
    return ouster_packets_of(read_ouster_sensor(metadata));
  }
  for (const auto& file : files) {
    if (const std::string text = told_metadata(*file); !text.empty()) {
      return ouster_packets_of(parse_ouster_sensor(file->path(), text));
    }
  }
  const fs::path beside = find_ouster_metadata(recording);
  return beside.empty() ? std::nullopt
                        : std::optional(ouster_packets_of(read_ouster_sensor(beside)));
}

std::optional<Datagram> datagram_of(const Channel& channel, const RawMessage& message) {
  try {
    const auto packet = ros::decode<ros::PacketMsg>(channel.encoding, message.bytes);
    return Datagram{.received = message.received, .payload = packet.data, .offset = message.offset};
  } catch (const ros::CodecError&) {
    return std::nullopt;
  }
}

uint64_t count_sweeps(const std::vector<Event>& events) {
  return static_cast<uint64_t>(std::ranges::count(events, PacketDecoder::kSweeps, &Event::topic));
}

uint64_t count_sweeps(const MessageFile& file, OrderedPackets& packets) {
  MessageSelection selection;
  for (std::size_t i = 0; i < file.channels().size(); ++i) {
    if (is_packet_channel(file.channels()[i]) && !is_imu_packet_channel(file.channels()[i])) {
      selection.channels.push_back(i);
    }
  }
  uint64_t sweeps = 0;
  const auto stream = selection.channels.empty() ? nullptr : file.messages(selection);
  for (bool more = stream != nullptr; more;) {
    try {
      const std::optional<RawMessage> message = stream->next();
      more = message.has_value();
      const auto datagram =
          message ? datagram_of(file.channels()[message->channel], *message) : std::nullopt;
      if (datagram) {
        sweeps += count_sweeps(packets.take(*datagram));
      }
    } catch (const InputError&) {
      // reported where the events are read
    }
  }
  return sweeps;
}

}  // namespace adit
