// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/recording_converter.hpp"

#include <algorithm>
#include <numeric>

#include "adit/tools/clouds/cloud_origin.hpp"
#include "adit/tools/clouds/returns.hpp"
#include "adit/tools/containers/ros_definitions.hpp"
#include "adit/tools/recordings/latched_messages.hpp"
#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/recordings/ros_transcode.hpp"
#include "adit/tools/setup/configured_recording.hpp"

namespace adit {
namespace {

constexpr std::size_t kKeptErrors = 10;
constexpr std::size_t kComparedErrors = 10000;

}  // namespace

uint64_t ConvertReport::messages() const {
  return std::accumulate(
      topics.begin(), topics.end(), uint64_t{0},
      [](uint64_t sum, const ConvertedTopic& topic) { return sum + topic.messages; });
}

std::string event_topic(const Topic& topic) {
  return topic.name.starts_with('/') ? topic.name : "/points";
}

void RecordingConverter::add_error(const InputError& error) {
  // What is read for latched messages is read again for the others.
  if (errors_.size() < kComparedErrors && !errors_.insert(error.what()).second) {
    return;
  }
  ++report_.error_count;
  if (report_.errors.size() < kKeptErrors) {
    report_.errors.emplace_back(error.what());
  }
}

/// Calls step() until it has nothing more, past the damage that it reports.
void RecordingConverter::run(const std::function<bool()>& step) {
  for (bool more = true; more;) {
    try {
      more = step();
    } catch (const InputError& error) {
      add_error(error);
    }
  }
}

bool RecordingConverter::is_repaired(const Channel& channel) const {
  const TopicKind kind = ros::kind_of(channel);
  return conversion_.repair && (kind == TopicKind::sweeps || kind == TopicKind::imu);
}

RecordingConverter::Route RecordingConverter::route_of(const Channel& channel) {
  const auto known = routes_.find({channel.topic, channel.type});
  if (known != routes_.end()) {
    return known->second;
  }
  Route route{.topic = report_.topics.size(),
              .from = channel.encoding,
              .to = conversion_.encoding.value_or(channel.encoding)};
  ConvertedTopic topic{.topic = channel.topic, .type = channel.type};
  const std::vector<std::string>& kept = conversion_.topics;
  const std::optional<std::string> shared = ros::shared_type_name(channel.type);
  const bool stays = route.from == route.to;
  if (!kept.empty() && std::ranges::count(kept, channel.topic) == 0) {
    topic.left_out = "not chosen";
  } else if (channel.encoding == Encoding::other) {
    topic.left_out = "neither ROS 1 nor ROS 2";
  } else if (!stays && !shared) {
    topic.left_out = "its type is not known well enough to translate it";
  } else if (is_repaired(channel)) {
    const bool sweeps = ros::kind_of(channel) == TopicKind::sweeps;
    topic.type = sweeps ? "sensor_msgs/PointCloud2" : channel.type;
    route.repaired = true;
    route.channel =
        writer_->add_channel({.topic = channel.topic,
                              .type = topic.type,
                              .encoding = route.to,
                              .definition = ros::definition_of(topic.type, route.to).value().text,
                              .messages = std::nullopt});
  } else {
    Channel copy = channel;
    if (!stays) {
      copy.type = *shared;
      copy.encoding = route.to;
      copy.metadata.clear();
    }
    if (!stays || copy.definition.empty()) {
      const auto definition = ros::definition_of(shared.value_or(copy.type), route.to);
      copy.definition = definition ? definition->text : std::string();
    }
    route.channel = writer_->add_channel(copy);
  }
  report_.topics.push_back(std::move(topic));
  return routes_[{channel.topic, channel.type}] = route;
}

void RecordingConverter::copy_latched(const std::vector<std::unique_ptr<MessageFile>>& files,
                                      Nanoseconds begin) {
  LatchedMessages latched;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::vector<Channel>& channels = files[i]->channels();
    MessageSelection selection{.channels = {}, .end = begin - Nanoseconds(1)};
    for (std::size_t k = 0; k < channels.size(); ++k) {
      // Every channel gets its route here, so that the report keeps their order.
      if (route_of(channels[k]).channel && is_latched(channels[k])) {
        selection.channels.push_back(k);
      }
    }
    if (selection.channels.empty()) {
      continue;
    }
    const auto stream = files[i]->messages(selection);
    run([&] {
      const std::optional<RawMessage> message = stream->next();
      if (message) {
        latched.add(i, channels[message->channel], *message);
      }
      return message.has_value();
    });
  }
  const std::vector<LatchedMessages::Held> held = latched.held();
  auto next = held.begin();
  run([&] {
    if (next == held.end()) {
      return false;
    }
    const LatchedMessages::Held& one = *next++;
    const MessageFile& file = *files[one.file];
    const Route route = route_of(file.channels()[one.channel]);
    write(file, route, {one.channel, begin, one.bytes, one.offset});
    ++report_.topics[route.topic].from_before;
    return true;
  });
}

void RecordingConverter::copy_latched(const Recording& recording, Nanoseconds begin) {
  EventSelection selection{.topics = {}, .end = begin - Nanoseconds(1)};
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    if (recording.topics()[i].kind == TopicKind::transforms) {
      selection.topics.push_back(i);
    }
  }
  if (!selection.topics.empty()) {
    copy_events(recording, selection, begin);
  }
}

void RecordingConverter::copy(const MessageFile& file, const TimeSpan& span) {
  std::vector<Route> routes;
  MessageSelection selection{.channels = {}, .begin = span.begin, .end = span.end};
  for (std::size_t i = 0; i < file.channels().size(); ++i) {
    routes.push_back(route_of(file.channels()[i]));
    if (routes.back().channel) {
      selection.channels.push_back(i);
    }
  }
  const uint64_t errors = report_.error_count;
  std::vector<std::optional<uint64_t>> counts(file.channels().size());
  for (const std::size_t channel : selection.channels) {
    counts[channel] = 0;
  }
  if (!selection.channels.empty()) {
    const auto stream = file.messages(selection);
    run([&] {
      const std::optional<RawMessage> message = stream->next();
      if (message) {
        ++*counts[message->channel];
        write(file, routes[message->channel], *message);
      }
      return message.has_value();
    });
  }
  if (report_.error_count == errors && file.damage()) {
    add_error(*file.damage());  // before the first message, or outside of the span
  }
  if (span.begin == Nanoseconds::min() && span.end == Nanoseconds::max()) {
    for (const DeclarationError& error : contradictions_of(file, counts)) {
      const std::vector<std::string>& kept = conversion_.topics;
      if (error.topic().empty() || kept.empty() || std::ranges::count(kept, error.topic()) > 0) {
        add_error(error);
      }
    }
  }
}

void RecordingConverter::copy(const Recording& recording, const TimeSpan& span) {
  copy_events(recording, {.begin = span.begin, .end = span.end}, std::nullopt);
}

/// The events, as received when they were or else at `received`.
void RecordingConverter::copy_events(const Recording& recording, const EventSelection& selection,
                                     std::optional<Nanoseconds> received) {
  const auto events = recording.events(selection);
  run([&] {
    std::optional<Event> event = events->next();
    if (event) {
      event->received = received.value_or(event->received);
      const std::size_t topic = write(*event, event_topic(recording.topics()[event->topic]));
      report_.topics[topic].from_before += received ? 1U : 0U;
    }
    return event.has_value();
  });
}

/// The frame of clouds whose coordinates are what is left of large ones: "lidar_local", which
/// /tf_static places in "lidar" by the offset.
std::string RecordingConverter::frame_with_offset(const std::string& frame,
                                                  const Eigen::Vector3d& offset,
                                                  Nanoseconds received) {
  if (offset.isZero(0.0)) {
    return frame;
  }
  const std::string local = frame + "_local";
  if (placed_frames_.insert(local).second) {
    StaticTransform transform{.parent = frame, .child = local};
    transform.T_parent_child = Eigen::Translation3d(offset);
    write(Event{.topic = 0, .received = received, .value = transform}, "/tf_static");
    report_.notes.push_back("the coordinates of " + frame + " are large: " + offset_text(offset) +
                            " is subtracted from all clouds, so that they keep their millimetres; "
                            "their frame is " +
                            local + ", and /tf_static places it in " + frame);
  }
  return local;
}

void RecordingConverter::note_coarse(const std::string& topic, double step) {
  if (step > 0.0 && coarse_topics_.insert(topic).second) {
    report_.notes.push_back(topic + ": " + coarse_note(step));
  }
}

/// The events of a message, corrected, as messages.
void RecordingConverter::write_repaired(const MessageFile& file, const Route& route,
                                        const RawMessage& message) {
  try {
    const std::string& topic = file.channels()[message.channel].topic;
    CloudReading reading{.time_unit = conversion_.repair->point_time_unit,
                         .coordinate_scale = conversion_.repair->coordinate_scale};
    if (const auto known = offsets_.find(topic); known != offsets_.end()) {
      reading.offset = known->second;
    }
    ros::MessageEvents events =
        ros::to_events(file.channels()[message.channel], message, file.path(), reading);
    for (const InputError& fault : events.faults) {
      add_error(fault);
    }
    note_coarse(topic, events.coordinate_step);
    for (EventValue& value : events.values) {
      std::string frame = events.frame;
      if (const auto* sweep = std::get_if<Sweep>(&value)) {
        if (std::ranges::any_of(sweep->points, is_return)) {
          offsets_.emplace(topic, sweep->offset);
        }
        frame = frame_with_offset(frame, sweep->offset, message.received);
      }
      const EventValue right = corrected(std::move(value), *conversion_.repair);
      writer_->write(*route.channel, message.received,
                     ros::from_event(right, route.to, frame, events.has_intensity).bytes);
    }
  } catch (const ros::CodecError& error) {
    throw InputError(file.path(), Place::byte(message.offset),
                     "a message of " + report_.topics[route.topic].topic +
                         " cannot be repaired: " + error.what(),
                     "It is left out");
  }
}

void RecordingConverter::write_translated(const MessageFile& file, const Route& route,
                                          const RawMessage& message) {
  const ConvertedTopic& topic = report_.topics[route.topic];
  std::vector<std::byte> bytes;
  try {
    bytes = ros::transcode(topic.type, route.from, message.bytes, route.to);
  } catch (const ros::CodecError& error) {
    throw InputError(file.path(), Place::byte(message.offset),
                     "a message of " + topic.topic + " cannot be translated: " + error.what(),
                     "It is left out");
  }
  writer_->write(*route.channel, message.received, bytes);
}

void RecordingConverter::write(const MessageFile& file, const Route& route,
                               const RawMessage& message) {
  if (route.repaired) {
    write_repaired(file, route, message);
  } else if (route.from == route.to) {
    writer_->write(*route.channel, message.received, message.bytes);
  } else {
    write_translated(file, route, message);
  }
  ++report_.topics[route.topic].messages;
}

/// Returns the topic's place in the report.
std::size_t RecordingConverter::write(const Event& event, const std::string& topic) {
  const Encoding encoding = conversion_.encoding.value_or(Encoding::cdr);
  std::string frame = event.frame.empty() ? "lidar" : event.frame;
  if (const auto* sweep = std::get_if<Sweep>(&event.value)) {
    frame = frame_with_offset(frame, sweep->offset, event.received);
    note_coarse(topic, event.coordinate_step);
  }
  const ros::EncodedEvent message =
      ros::from_event(event.value, encoding, frame, event.has_intensity);
  const Route route = route_of({.topic = topic,
                                .type = message.type,
                                .encoding = encoding,
                                .definition = {},
                                .messages = std::nullopt});
  if (route.channel) {
    writer_->write(*route.channel, event.received, message.bytes);
    ++report_.topics[route.topic].messages;
  }
  return route.topic;
}

}  // namespace adit
