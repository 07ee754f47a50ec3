// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/latched_messages.hpp"

#include <algorithm>
#include <variant>

#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/recordings/ros_messages.hpp"

namespace adit {
namespace {

bool has_line(const Channel& channel, const char* key, const char* part) {
  const auto found = channel.metadata.find(key);
  return found != channel.metadata.end() && found->second.find(part) != std::string::npos;
}

/// The frames that the message mounts; empty where it mounts none or cannot be read.
std::string children_of(const Channel& channel, const RawMessage& message) {
  std::string children;
  try {
    for (const EventValue& value : ros::to_events(channel, message, {}).values) {
      if (const auto* transform = std::get_if<StaticTransform>(&value)) {
        children += transform->child + "\n";
      }
    }
  } catch (const ros::CodecError&) {
    return {};  // copied as it is; whoever reads it reports it
  }
  return children;
}

}  // namespace

bool is_latched(const Channel& channel) {
  return ros::kind_of(channel) == TopicKind::transforms || channel.type == ros::CameraInfo::kType ||
         has_line(channel, "latching", "1") ||
         has_line(channel, "offered_qos_profiles", "durability: 1") ||
         has_line(channel, "offered_qos_profiles", "durability: transient_local");
}

void LatchedMessages::add(std::size_t file, const Channel& channel, const RawMessage& message) {
  const bool transforms = ros::kind_of(channel) == TopicKind::transforms;
  Held one{file, message.channel, message.offset, {}};
  one.bytes.assign(message.bytes.begin(), message.bytes.end());
  messages_[{channel.topic, transforms ? children_of(channel, message) : std::string()}] = {
      added_++, std::move(one)};
}

std::vector<LatchedMessages::Held> LatchedMessages::held() const {
  std::vector<std::pair<uint64_t, Held>> all;
  for (const auto& [key, entry] : messages_) {
    all.push_back(entry);
  }
  std::ranges::sort(all, {}, &std::pair<uint64_t, Held>::first);
  std::vector<Held> messages;
  for (auto& [order, message] : all) {
    messages.push_back(std::move(message));
  }
  return messages;
}

}  // namespace adit
