// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/convert_recording.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <memory>
#include <utility>

#include "adit/tools/containers/bag_writer.hpp"
#include "adit/tools/containers/mcap_writer.hpp"
#include "adit/tools/containers/ros_definitions.hpp"
#include "adit/tools/containers/rosbag2_writer.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/recordings/ros_transcode.hpp"
#include "adit/tools/run/configured_recording.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kKeptErrors = 10;

enum class Format { mcap, bag, rosbag2 };

Format format_of(const fs::path& output) {
  if (output.extension() == ".mcap") {
    return Format::mcap;
  }
  return output.extension() == ".bag" ? Format::bag : Format::rosbag2;
}

/// The one encoding that the format holds; nothing where it holds all.
std::optional<Encoding> encoding_of(Format format) {
  switch (format) {
    case Format::bag:
      return Encoding::ros1;
    case Format::rosbag2:
      return Encoding::cdr;
    case Format::mcap:
      break;
  }
  return std::nullopt;
}

/// The profile of an MCAP file: that of all messages, where they have one in common.
std::string profile_of(const ConvertOptions& options,
                       const std::vector<std::unique_ptr<MessageFile>>& files) {
  std::optional<Encoding> common = options.encoding;
  if (!common && files.empty()) {
    common = Encoding::cdr;
  }
  if (!common) {
    for (const auto& file : files) {
      for (const Channel& channel : file->channels()) {
        if (common && common != channel.encoding) {
          return {};
        }
        common = channel.encoding;
      }
    }
  }
  return common == Encoding::cdr ? "ros2" : common == Encoding::ros1 ? "ros1" : "";
}

std::unique_ptr<MessageWriter> make_writer(const ConvertOptions& options, std::string profile) {
  const Format format = format_of(options.output);
  const auto compression = [&](Compression usual, Compression not_in_it) {
    const Compression chosen = options.compression.value_or(usual);
    if (chosen == not_in_it) {
      throw UsageError("--compression " + std::string(to_string(chosen)) + ": " +
                       options.output.filename().string() + " cannot hold it.");
    }
    return chosen;
  };
  if (format == Format::mcap) {
    return std::make_unique<McapWriter>(
        options.output, McapOptions{.compression = compression(Compression::zstd, Compression::bz2),
                                    .profile = std::move(profile)});
  }
  if (format == Format::bag) {
    return std::make_unique<BagWriter>(
        options.output,
        BagOptions{.compression = compression(Compression::lz4, Compression::zstd)});
  }
  const Compression chosen = compression(Compression::none, Compression::bz2);
  if (chosen == Compression::lz4) {
    throw UsageError("--compression lz4: rosbag2's SQLite storage knows none and zstd.");
  }
  return std::make_unique<Rosbag2Writer>(
      options.output, Rosbag2Options{.pack_messages = chosen == Compression::zstd});
}

/// Folders of sweeps have no name that a message could go by.
std::string event_topic(const Topic& topic) {
  return topic.name.starts_with('/') ? topic.name : "/points";
}

/// Where the messages of a channel go.
struct Route {
  std::size_t topic = 0;  ///< index into the report
  Encoding from = Encoding::other;
  Encoding to = Encoding::other;
  std::optional<std::size_t> channel{};  ///< of the writer; none: left out
  bool repaired = false;
};

class Converter {
 public:
  Converter(const ConvertOptions& options, MessageWriter& writer)
      : options_(&options), writer_(&writer) {}

  ConvertReport take() && { return std::move(report_); }

  void copy(const MessageFile& file, const TimeSpan& span) {
    std::vector<Route> routes;
    MessageSelection selection{.channels = {}, .begin = span.begin, .end = span.end};
    for (std::size_t i = 0; i < file.channels().size(); ++i) {
      routes.push_back(route_of(file.channels()[i]));
      if (routes.back().channel) {
        selection.channels.push_back(i);
      }
    }
    if (selection.channels.empty()) {
      return;
    }
    const auto stream = file.messages(selection);
    const auto step = [&] {
      const std::optional<RawMessage> message = stream->next();
      if (message) {
        write(file, routes[message->channel], *message);
      }
      return message.has_value();
    };
    run(step);
  }

  void copy_events(const Recording& recording, const TimeSpan& span) {
    const auto events = recording.events({.begin = span.begin, .end = span.end});
    const Encoding encoding = options_->encoding.value_or(
        encoding_of(format_of(options_->output)).value_or(Encoding::cdr));
    const auto step = [&] {
      const std::optional<Event> event = events->next();
      if (event) {
        write(*event, event_topic(recording.topics()[event->topic]), encoding);
      }
      return event.has_value();
    };
    run(step);
  }

 private:
  /// Calls step() until it has nothing more, past the damage that it reports.
  template <class Step>
  void run(const Step& step) {
    for (bool more = true; more;) {
      try {
        more = step();
      } catch (const InputError& error) {
        ++report_.error_count;
        if (report_.errors.size() < kKeptErrors) {
          report_.errors.emplace_back(error.what());
        }
      }
    }
  }

  bool is_repaired(const Channel& channel) const {
    const TopicKind kind = ros::kind_of(channel);
    return options_->repair && (kind == TopicKind::sweeps || kind == TopicKind::imu);
  }

  Route route_of(const Channel& channel) {
    const auto known = routes_.find({channel.topic, channel.type});
    if (known != routes_.end()) {
      return known->second;
    }
    Route route{.topic = report_.topics.size(),
                .from = channel.encoding,
                .to = options_->encoding.value_or(
                    encoding_of(format_of(options_->output)).value_or(channel.encoding))};
    ConvertedTopic topic{.topic = channel.topic, .type = channel.type};
    const std::vector<std::string>& kept = options_->topics;
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

  /// The events of a message, corrected, as messages.
  void write_repaired(const MessageFile& file, const Route& route, const RawMessage& message) {
    try {
      ros::MessageEvents events = ros::to_events(file.channels()[message.channel], message,
                                                 file.path(), options_->repair->point_time_unit);
      for (EventValue& value : events.values) {
        const EventValue right = corrected(std::move(value), *options_->repair);
        writer_->write(*route.channel, message.received,
                       ros::from_event(right, route.to, events.frame).bytes);
      }
    } catch (const ros::CodecError& error) {
      throw InputError(file.path(), Place::byte(message.offset),
                       "a message of " + report_.topics[route.topic].topic +
                           " cannot be repaired: " + error.what(),
                       "It is left out");
    }
  }

  void write(const MessageFile& file, const Route& route, const RawMessage& message) {
    if (route.repaired) {
      write_repaired(file, route, message);
    } else if (route.from == route.to) {
      writer_->write(*route.channel, message.received, message.bytes);
    } else {
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
    ++report_.topics[route.topic].messages;
  }

  void write(const Event& event, const std::string& topic, Encoding encoding) {
    const std::string frame = event.frame.empty() ? "lidar" : event.frame;
    const ros::EncodedEvent message = ros::from_event(event.value, encoding, frame);
    const Route route = route_of({.topic = topic,
                                  .type = message.type,
                                  .encoding = encoding,
                                  .definition = {},
                                  .messages = std::nullopt});
    if (route.channel) {
      writer_->write(*route.channel, event.received, message.bytes);
      ++report_.topics[route.topic].messages;
    }
  }

  const ConvertOptions* options_;
  MessageWriter* writer_;
  ConvertReport report_;
  std::map<std::pair<std::string, std::string>, Route> routes_;  // by topic and type
};

/// The part to keep, from what the options say in seconds after `begin`.
TimeSpan chosen_span(const ConvertOptions& options, Nanoseconds begin) {
  TimeSpan span{Nanoseconds::min(), Nanoseconds::max()};
  if (options.begin_s) {
    span.begin = begin + to_nanoseconds(*options.begin_s).value_or(Nanoseconds(0));
  }
  if (options.end_s) {
    span.end = begin + to_nanoseconds(*options.end_s).value_or(Nanoseconds(0));
  }
  return span;
}

void require_topics(const ConvertOptions& options, const std::vector<std::string>& names) {
  for (const std::string& topic : options.topics) {
    if (std::ranges::count(names, topic) == 0) {
      throw UsageError("--topic " + topic + ": the recording has no such topic. " +
                       suggestion(topic, names) + ".");
    }
  }
}

}  // namespace

ConvertReport convert_recording(const ConvertOptions& options) {
  const std::optional<Encoding> only = encoding_of(format_of(options.output));
  if (options.encoding && only && options.encoding != only) {
    throw UsageError("--ros: " + options.output.filename().string() + " holds " +
                     (only == Encoding::ros1 ? "ROS 1" : "ROS 2") + " messages alone.");
  }
  const auto files = open_message_files(options.input);
  std::unique_ptr<Recording> sweeps;
  std::vector<std::string> names;
  std::optional<Nanoseconds> begin;
  if (files.empty()) {
    sweeps = open_recording(options.input, options.repair.value_or(RecordingConfig{}));
    std::ranges::transform(sweeps->topics(), std::back_inserter(names), event_topic);
    const auto first = sweeps->events({})->next();
    begin = first ? std::optional(first->received) : std::nullopt;
  }
  for (const auto& file : files) {
    for (const Channel& channel : file->channels()) {
      names.push_back(channel.topic);
    }
    if (const std::optional<TimeSpan> span = file->span()) {
      begin = std::min(begin.value_or(span->begin), span->begin);
    }
  }
  require_topics(options, names);
  const TimeSpan span = chosen_span(options, begin.value_or(Nanoseconds(0)));
  const std::unique_ptr<MessageWriter> writer = make_writer(options, profile_of(options, files));
  Converter converter(options, *writer);
  for (const auto& file : files) {
    converter.copy(*file, span);
  }
  if (sweeps) {
    converter.copy_events(*sweeps, span);
  }
  writer->close();
  return std::move(converter).take();
}

}  // namespace adit
