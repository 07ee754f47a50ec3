// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/message_recording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <deque>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/clouds/point_time_vote.hpp"
#include "adit/tools/clouds/returns.hpp"
#include "adit/tools/containers/live_metadata.hpp"
#include "adit/tools/recordings/message_cameras.hpp"
#include "adit/tools/recordings/packet_messages.hpp"
#include "adit/tools/recordings/recording_parts.hpp"
#include "adit/tools/recordings/ros_codec.hpp"
#include "adit/tools/recordings/ros_events.hpp"
#include "adit/tools/recordings/ros_messages.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

using Part = RecordingPart;

/// The packets of a sensor in messages, and the topics of its events.
struct PacketTopics {
  PacketSensor sensor;
  std::size_t sweeps = 0;
  std::size_t imu = 0;
  std::size_t transforms = 0;
  Nanoseconds begin{0};  ///< the recording's
};

/// A message that waits for its place among the packets, with its bytes, or damage in its place.
struct HeldMessage {
  Nanoseconds received{0};
  const Part* part = nullptr;
  RawMessage message{};
  std::vector<std::byte> bytes{};
  std::optional<InputError> damage{};
};

/// How the clouds of a topic are to be read, all alike, by what the first of them tell: the unit of
/// their points' times, and where they lie. Damaged ones do not count.
CloudReading told_reading(const std::vector<Part>& parts, std::size_t topic,
                          const EventSelection& selected) {
  CloudReading reading{.coordinate_scale = selected.coordinate_scale};
  PointTimeVote vote;
  std::size_t asked = 0;
  for (const Part& part : parts) {
    MessageSelection selection;
    for (std::size_t i = 0; i < part.topics.size(); ++i) {
      if (part.topics[i] == topic) {
        selection.channels.push_back(i);
      }
    }
    if (selection.channels.empty()) {
      continue;
    }
    const auto stream = part.file->messages(selection);
    for (bool more = true; more && asked < PointTimeVote::kSweeps; ++asked) {
      try {
        const std::optional<RawMessage> message = stream->next();
        more = message.has_value();
        if (message) {
          const ros::MessageEvents events = ros::to_events(part.file->channels()[message->channel],
                                                           *message, part.file->path(), reading);
          const auto& sweep = std::get<Sweep>(events.values.at(0));
          if (std::ranges::any_of(sweep.points, is_return)) {
            reading.offset = reading.offset.value_or(sweep.offset);
          }
          if (events.point_times) {
            vote.add(sweep, *events.point_times);
          }
        }
      } catch (const InputError&) {
        // reported where the events are read
      } catch (const ros::CodecError&) {
        // likewise
      }
    }
  }
  reading.time_unit = selected.point_time_unit ? selected.point_time_unit : vote.unit();
  return reading;
}

class MessageEventStream final : public EventStream {
 public:
  MessageEventStream(const std::vector<Part>& parts, const std::vector<Topic>& topics,
                     const MessageTimes& times, const PacketTopics* packets,
                     EventSelection selection)
      : parts_(&parts),
        selection_(std::move(selection)),
        packets_(packets),
        taken_(topics.size()),
        readings_(topics.size()) {
    for (std::size_t i = 0; i < topics.size(); ++i) {
      const bool chosen = selection_.topics.empty() || std::ranges::count(selection_.topics, i) > 0;
      wanted_.push_back(chosen && topics[i].kind != TopicKind::other);
    }
    stream_ = read_parts(
        parts, topics,
        {.wanted = wanted_, .received = {selection_.begin, selection_.end}, .times = times});
    if (packets_ != nullptr) {
      decoder_.emplace(packets_->sensor, true);
      const Nanoseconds first = packets_->begin;
      if (wanted_[packets_->transforms] && first >= selection_.begin && first <= selection_.end) {
        for (Event& event : ouster_transforms(*packets_->sensor.ouster, first)) {
          add_packet_event(std::move(event));
        }
      }
    }
  }

  std::optional<Event> next() override {
    while (true) {
      if (!faults_.empty()) {  // of the events that are ready
        const InputError fault = faults_.front();
        faults_.pop_front();
        throw InputError(fault);
      }
      if (!ready_.empty()) {
        Event event = std::move(ready_.front());
        ready_.pop_front();
        return event;
      }
      if (std::optional<HeldMessage> held = order_.next(ended_)) {
        take_held(*held);
        continue;
      }
      if (ended_) {
        std::optional<Event> last = decoder_ ? decoder_->finish() : std::nullopt;
        decoder_.reset();
        if (!last) {
          return std::nullopt;
        }
        add_packet_event(std::move(*last));
        continue;
      }
      read();
    }
  }

 private:
  void read() {
    std::optional<PartMessage> message;
    try {
      message = stream_->next();
    } catch (const InputError& error) {
      if (packets_ == nullptr) {
        throw;
      }
      order_.add({.damage = error});
      return;
    }
    if (!message) {
      ended_ = true;
    } else if (packets_ == nullptr) {
      current_ = message->part;
      take(message->message);
    } else {
      hold(*message);
    }
  }

  /// Nothing for messages that are no packets of the sensor.
  std::optional<PacketPlace> place_of_packet(const PartMessage& message) const {
    const Channel& channel = message.part->file->channels()[message.message.channel];
    if (!is_packet_channel(channel)) {
      return std::nullopt;
    }
    const std::optional<Datagram> datagram = datagram_of(channel, message.message);
    return datagram ? place_of(*datagram, packets_->sensor) : std::nullopt;
  }

  /// Packets of the sensor take their places in the order of its clock; what lies between them
  /// keeps its own.
  void hold(const PartMessage& read) {
    const RawMessage& message = read.message;
    HeldMessage held{.received = message.received,
                     .part = read.part,
                     .message = message,
                     .bytes = {message.bytes.begin(), message.bytes.end()}};
    if (const std::optional<PacketPlace> place = place_of_packet(read)) {
      order_.add(std::move(held), *place);
    } else {
      order_.add(std::move(held));
    }
  }

  void take_held(HeldMessage& held) {
    if (held.damage) {
      throw InputError(*held.damage);
    }
    current_ = held.part;
    held.message.received = held.received;
    held.message.bytes = held.bytes;
    take(held.message);
  }

  /// An event of the packets' own topics.
  void add_packet_event(Event event) {
    const std::array<std::size_t, 3> topics = {packets_->sweeps, packets_->imu,
                                               packets_->transforms};
    event.topic = topics[event.topic];
    if (!wanted_[event.topic]) {
      return;
    }
    if (skipped_ < selection_.skip) {
      ++skipped_;
      return;
    }
    ready_.push_back(std::move(event));
  }

  void take_packet(const Channel& channel, const RawMessage& message) {
    const std::optional<Datagram> datagram = datagram_of(channel, message);
    if (!datagram) {
      throw InputError(current_->file->path(), Place::byte(message.offset),
                       "a message of " + channel.topic + " is no whole packet",
                       "The message is damaged; the others can be read");
    }
    for (Event& event : decoder_->take(*datagram)) {
      if (event.topic != PacketDecoder::kTransforms) {  // those were reported at the begin
        add_packet_event(std::move(event));
      }
    }
  }

  void take(const RawMessage& message) {
    const Channel& channel = current_->file->channels()[message.channel];
    const std::size_t topic = current_->topics[message.channel];
    if (!wanted_[topic]) {
      return;
    }
    if (packets_ != nullptr && is_packet_channel(channel)) {
      take_packet(channel, message);
      return;
    }
    const uint64_t number = taken_[topic]++;
    if (skipped_ < selection_.skip) {
      ++skipped_;
      return;
    }
    const fs::path& file = current_->file->path();
    const std::string place = "message " + std::to_string(number) + " of " + channel.topic +
                              " (at byte " + std::to_string(message.offset) + ")";
    const auto fail = [&](const std::string& at, const std::string& found,
                          const std::string& remedy) {
      throw InputError(file, Place::named(place + at), found, remedy);
    };
    std::vector<std::string> left_out;
    try {
      ros::MessageEvents events =
          selection_.velocities_of == topic && channel.type == ros::Odometry::kType
              ? ros::to_velocity(channel, message)
          : selection_.headings_of == topic && channel.type == ros::Imu::kType
              ? ros::to_reading_and_heading(channel, message)
              : ros::to_events(channel, message, file, reading_of(topic, channel),
                               current_->cameras[message.channel].get());
      for (EventValue& value : events.values) {
        if (auto* sweep = std::get_if<Sweep>(&value)) {
          sweep->source = channel.topic + "#" + std::to_string(number);
        }
        ready_.push_back({topic, message.received, std::move(value),
                          ready_.empty() ? message.bytes.size() : 0, events.frame,
                          events.point_times, number, events.has_intensity,
                          events.coordinate_step});
      }
      for (const InputError& fault : events.faults) {
        faults_.emplace_back(file, Place::named(place + ", " + fault.place()), fault.found(),
                             fault.remedy());
      }
      left_out = std::move(events.left_out);
    } catch (const ros::CodecError& error) {
      fail(
          "", "it is no whole " + channel.type + ": " + error.what(),
          "The message is damaged, or not of the type that the file tells; the others can be read");
    } catch (const InputError& error) {
      fail(", " + error.place(), error.found(), error.remedy());
    }
    if (!left_out.empty()) {
      const std::size_t others = left_out.size() - 1;
      fail("", left_out.front() + (others == 0 ? "" : fmt::format(" (and {} more)", others)),
           "It is left out, and the others of the message are read; correct its publisher");
    }
  }

  CloudReading reading_of(std::size_t topic, const Channel& channel) {
    if (channel.type != ros::PointCloud2::kType) {
      return {.time_unit = selection_.point_time_unit,
              .coordinate_scale = selection_.coordinate_scale};
    }
    std::optional<CloudReading>& reading = readings_[topic];
    if (!reading) {
      reading = told_reading(*parts_, topic, selection_);
    }
    return *reading;
  }

  const std::vector<Part>* parts_;
  EventSelection selection_;
  const PacketTopics* packets_;                        // null where there are none
  std::optional<PacketDecoder> decoder_;               // their decoder
  PacketOrder<HeldMessage> order_;                     // what waits, if there are
  bool ended_ = false;                                 // no message is left to read
  std::vector<bool> wanted_;                           // by topic
  std::vector<uint64_t> taken_;                        // messages so far, by topic
  std::vector<std::optional<CloudReading>> readings_;  // by topic, once asked for
  uint64_t skipped_ = 0;
  const Part* current_ = nullptr;
  std::unique_ptr<PartStream> stream_;
  std::deque<Event> ready_;
  std::deque<InputError> faults_;
};

class MessageRecording final : public Recording {
 public:
  MessageRecording(std::vector<fs::path> paths, std::vector<std::unique_ptr<MessageFile>> files,
                   const fs::path& metadata)
      : paths_(std::move(paths)) {
    if (std::optional<PacketSensor> sensor = packet_sensor_of(files, paths_.front(), metadata)) {
      packets_.emplace(PacketTopics{.sensor = std::move(*sensor)});
    }
    std::vector<const MessageFile*> all;
    for (const std::unique_ptr<MessageFile>& file : files) {
      all.push_back(file.get());
    }
    for (std::unique_ptr<MessageFile>& file : files) {
      Part part{std::move(file), {}, {}};
      for (std::size_t i = 0; i < part.file->channels().size(); ++i) {
        const Channel& channel = part.file->channels()[i];
        const bool images =
            channel.type == ros::Image::kType && channel.encoding != Encoding::other;
        part.cameras.push_back(images ? find_depth_camera(*part.file, i, all) : nullptr);
        part.topics.push_back(topic_of(channel, part.cameras.back() != nullptr));
      }
      parts_.push_back(std::move(part));
    }
    if (packets_) {
      find_packet_topics();
    }
    times_ = times_of(parts_, topics_);
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  bool times_are_assumed() const override { return false; }

  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<MessageEventStream>(parts_, topics_, times_,
                                                packets_ ? &*packets_ : nullptr, selection);
  }

  std::vector<RecordingNotice> notices() const override {
    std::vector<RecordingNotice> notices = packet_notices_;
    for (const fs::path& path : paths_) {
      std::ranges::move(unlisted_file_notices(path), std::back_inserter(notices));
    }
    if (times_.order != MessageOrder::files) {
      const bool stamps = times_.order == MessageOrder::stamps;
      notices.push_back(
          {.kind = "grouped_by_topic",
           .found = std::string("its messages are grouped by topic") +
                    (stamps ? ", and by their times of receipt the topics follow each other; by "
                              "their stamps they were measured at the same time"
                            : ""),
           .effect = stamps ? "they are read in the order of their stamps"
                            : "they are read in the order of their times of receipt",
           .remedy = "Nothing need be done"});
    }
    return notices;
  }

  std::optional<double> recorded_wait() const override {
    for (const Part& part : parts_) {
      for (const Channel& channel : part.file->channels()) {
        const auto told = channel.metadata.find(kWaitKey);
        const std::string text = told == channel.metadata.end() ? "" : told->second;
        double wait = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), wait);
        if (error == std::errc{} && end == text.data() + text.size() && !text.empty()) {
          return wait;
        }
      }
    }
    return std::nullopt;
  }

  std::string description() const override {
    const auto is_there = [](const Part& part) { return !part.file->format().empty(); };
    const auto files = std::ranges::count_if(parts_, is_there);
    std::string text =
        text_of(paths_) + ": " + std::ranges::find_if(parts_, is_there)->file->format();
    if (files > 1) {
      text += " in " + std::to_string(files) + " files";
    }
    std::optional<TimeSpan> span;
    for (const Part& part : parts_) {
      if (const std::optional<TimeSpan> one = part.file->span()) {
        span = span ? TimeSpan{std::min(span->begin, one->begin), std::max(span->end, one->end)}
                    : *one;
      }
    }
    if (span) {
      const std::chrono::duration<double> duration = span->end - span->begin;
      const std::string seconds = std::to_string(duration.count());
      text += ", " + seconds.substr(0, seconds.find('.') + 2) + " s";
    }
    for (const Topic& topic : topics_) {
      if (topic.kind == TopicKind::sweeps) {
        text += ", " + std::to_string(topic.messages.value_or(0)) + " sweeps on " + topic.name;
      }
    }
    return text;
  }

 private:
  /// Counts the sweeps that the packets make; how the sensor is mounted is a topic of its own.
  void find_packet_topics() {
    packets_->transforms = topics_.size();
    topics_.push_back({"/tf_static (metadata)", "Ouster metadata", TopicKind::transforms, 2});
    packets_->sweeps = packets_->transforms;  // where there are none, no event comes of them
    packets_->imu = packets_->transforms;
    OrderedPackets packets(packets_->sensor, false);
    uint64_t sweeps = 0;
    std::optional<Nanoseconds> begin;
    for (const Part& part : parts_) {
      for (std::size_t i = 0; i < part.topics.size(); ++i) {
        const Channel& channel = part.file->channels()[i];
        if (is_packet_channel(channel)) {
          (is_imu_packet_channel(channel) ? packets_->imu : packets_->sweeps) = part.topics[i];
        }
      }
      sweeps += count_sweeps(*part.file, packets);
      if (const std::optional<TimeSpan> span = part.file->span()) {
        begin = std::min(begin.value_or(span->begin), span->begin);
      }
    }
    sweeps += count_sweeps(packets.flush());
    sweeps += packets.finish() ? 1U : 0U;
    packet_notices_ = order_notices(packets.counts());
    packets_->begin = begin.value_or(Nanoseconds(0));
    if (packets_->sweeps != packets_->transforms) {
      topics_[packets_->sweeps].messages = sweeps;
    }
  }

  TopicKind kind_of(const Channel& channel, bool depths) const {
    if (packets_ && is_packet_channel(channel)) {
      return is_imu_packet_channel(channel) ? TopicKind::imu : TopicKind::sweeps;
    }
    return depths ? TopicKind::sweeps : ros::kind_of(channel);
  }

  std::size_t topic_of(const Channel& channel, bool depths) {
    const TopicKind kind = kind_of(channel, depths);
    const auto found = std::ranges::find_if(topics_, [&](const Topic& topic) {
      return topic.name == channel.topic && topic.type == channel.type && topic.kind == kind;
    });
    if (found != topics_.end()) {
      if (channel.messages) {
        found->messages = found->messages.value_or(0) + *channel.messages;
      }
      return static_cast<std::size_t>(found - topics_.begin());
    }
    topics_.push_back({channel.topic, channel.type, kind, channel.messages});
    return topics_.size() - 1;
  }

  std::vector<fs::path> paths_;
  std::optional<PacketTopics> packets_;
  std::vector<RecordingNotice> packet_notices_;
  std::vector<Part> parts_;
  MessageTimes times_;
  std::vector<Topic> topics_;
};

}  // namespace

std::unique_ptr<Recording> make_message_recording(std::vector<fs::path> paths,
                                                  std::vector<std::unique_ptr<MessageFile>> files,
                                                  const fs::path& metadata) {
  return std::make_unique<MessageRecording>(std::move(paths), std::move(files), metadata);
}

}  // namespace adit
