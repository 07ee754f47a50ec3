// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/packet_decoder.hpp"

#include <functional>
#include <string_view>
#include <utility>

namespace adit {
namespace {

using Kind = PacketSensor::Kind;

const char* frame_of(Kind kind) {
  switch (kind) {
    case Kind::velodyne:
      return "velodyne";
    case Kind::ouster:
      return "os_lidar";
    case Kind::hesai:
      return "hesai_lidar";
    case Kind::livox:
      return "livox_frame";
  }
  return "lidar";
}

bool is_data(const Datagram& datagram, const PacketSensor& sensor) {
  switch (sensor.kind) {
    case Kind::velodyne:
      return is_velodyne_data(datagram);
    case Kind::ouster:
      return is_ouster_data(datagram, *sensor.ouster);
    case Kind::hesai:
      return hesai_packet(datagram).has_value();
    case Kind::livox:
      return is_livox_data(datagram);
  }
  return false;
}

/// By the sensor's clock, of a packet of ranges.
std::optional<Nanoseconds> time_of_data(const Datagram& datagram, const PacketSensor& sensor) {
  switch (sensor.kind) {
    case Kind::velodyne:
      return velodyne_time(datagram);
    case Kind::ouster:
      return ouster_time(datagram, *sensor.ouster);
    case Kind::hesai:
      return hesai_time(*hesai_packet(datagram), datagram);
    case Kind::livox:
      return livox_time(datagram);
  }
  return std::nullopt;
}

std::string count_of(uint64_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

}  // namespace

std::optional<PacketPlace> place_of(const Datagram& datagram, const PacketSensor& sensor) {
  const auto place = [&](std::size_t series, std::optional<Nanoseconds> time) {
    const std::string_view bytes(reinterpret_cast<const char*>(datagram.payload.data()),
                                 datagram.payload.size());
    return time ? std::optional(PacketPlace{.series = series,
                                            .time = *time,
                                            .content = std::hash<std::string_view>{}(bytes)})
                : std::nullopt;
  };
  if (is_data(datagram, sensor)) {
    return place(PacketDecoder::kSweeps, time_of_data(datagram, sensor));
  }
  if (sensor.kind == Kind::ouster && is_ouster_imu(datagram)) {
    return place(PacketDecoder::kSecond, ouster_imu(datagram).stamp);
  }
  if (sensor.kind == Kind::livox && is_livox_imu(datagram)) {
    return place(PacketDecoder::kSecond, livox_time(datagram));
  }
  return std::nullopt;
}

std::vector<RecordingNotice> order_notices(const PacketOrderCounts& counts) {
  std::vector<RecordingNotice> notices;
  if (counts.repeated > 0) {
    notices.push_back({"repeated_packets",
                       count_of(counts.repeated, "packet was", "packets were") + " captured twice",
                       "handled automatically: each packet is used once", "Nothing need be done"});
  }
  if (counts.reordered > 0) {
    notices.push_back(
        {"reordered_packets",
         count_of(counts.reordered, "packet", "packets") + " arrived after a later one",
         "handled automatically: packets are read in the order of the sensor's clock",
         "Nothing need be done"});
  }
  if (counts.late > 0) {
    notices.push_back(
        {"late_packets",
         count_of(counts.late, "packet", "packets") + " arrived too late to be put in order",
         "they are left out", "Check the network between sensor and computer"});
  }
  return notices;
}

PacketSensor ouster_packets_of(OusterSensor sensor) {
  return {.name = "Ouster with " + std::to_string(sensor.beams) + " beams",
          .kind = Kind::ouster,
          .ouster = std::move(sensor)};
}

std::vector<Topic> packet_topics(const PacketSensor& sensor) {
  std::vector<Topic> topics = {{"/points", sensor.name + " packets", TopicKind::sweeps, 0}};
  if (sensor.kind == Kind::velodyne) {
    topics.push_back({"/fix", sensor.name + " NMEA", TopicKind::gnss, 0});
  } else if (sensor.kind != Kind::hesai) {
    topics.push_back({"/imu", sensor.name + " packets", TopicKind::imu, 0});
  }
  if (sensor.kind == Kind::ouster) {
    topics.push_back({"/tf_static", "Ouster metadata", TopicKind::transforms, 0});
  }
  if (sensor.gpsd) {
    topics.push_back({"/gpsd/fix", "gpsd reports", TopicKind::gnss, 0});
  }
  return topics;
}

std::vector<Event> ouster_transforms(const OusterSensor& sensor, Nanoseconds received) {
  std::vector<Event> events;
  for (const auto& [child, T] :
       {std::pair{"os_lidar", sensor.T_sensor_lidar}, std::pair{"os_imu", sensor.T_sensor_imu}}) {
    events.push_back({.topic = PacketDecoder::kTransforms,
                      .received = received,
                      .value = StaticTransform{"os_sensor", child, T}});
  }
  return events;
}

PacketDecoder::PacketDecoder(const PacketSensor& sensor, bool points)
    : sensor_(&sensor), gpsd_topic_(packet_topics(sensor).size() - 1) {
  switch (sensor.kind) {
    case Kind::velodyne:
      sweeps_.emplace<VelodyneSweeps>(points);
      break;
    case Kind::ouster:
      sweeps_.emplace<OusterSweeps>(sensor.ouster.value(), points);
      break;
    case Kind::hesai:
      sweeps_.emplace<HesaiSweeps>(sensor.hesai.value(), points);
      break;
    case Kind::livox:
      sweeps_.emplace<LivoxSweeps>(points);
      break;
  }
}

/// What is reported beside the sweeps.
std::optional<Event> PacketDecoder::other(const Datagram& datagram) {
  const bool ouster = sensor_->kind == Kind::ouster && is_ouster_imu(datagram);
  const bool livox = sensor_->kind == Kind::livox && is_livox_imu(datagram);
  if (ouster || livox) {
    return Event{.topic = kSecond,
                 .received = datagram.received,
                 .value = ouster ? ouster_imu(datagram) : livox_imu(datagram),
                 .bytes = datagram.payload.size(),
                 .frame = ouster ? "os_imu" : "livox_frame"};
  }
  if (const std::string_view line = gpsd_line(datagram); sensor_->gpsd && !line.empty()) {
    const std::optional<GnssFix> fix = gpsd_.take(line, datagram.received);
    return fix ? std::optional(Event{.topic = gpsd_topic_,
                                     .received = datagram.received,
                                     .value = *fix,
                                     .bytes = line.size(),
                                     .frame = "gnss"})
               : std::nullopt;
  }
  if (sensor_->kind == Kind::velodyne && is_velodyne_position(datagram)) {
    const std::optional<GnssFix> fix = velodyne_fix(datagram);
    if (fix && fix->stamp != last_fix_) {  // a sentence is repeated until the next
      last_fix_ = fix->stamp;
      return Event{.topic = kSecond,
                   .received = datagram.received,
                   .value = *fix,
                   .bytes = datagram.payload.size()};
    }
  }
  return std::nullopt;
}

std::vector<Event> PacketDecoder::take(const Datagram& datagram) {
  std::vector<Event> events;
  if (sensor_->ouster && !told_) {
    told_ = true;
    events = ouster_transforms(*sensor_->ouster, datagram.received);
  }
  if (is_data(datagram, *sensor_)) {
    bytes_ += datagram.payload.size();
    auto whole = std::visit([&](auto& sweeps) { return sweeps.take(datagram); }, sweeps_);
    for (Sweep& sweep : whole) {
      events.push_back(event_of(std::move(sweep), datagram.received));
    }
    last_ = datagram.received;
  } else if (std::optional<Event> event = other(datagram)) {
    events.push_back(std::move(*event));
  }
  return events;
}

std::optional<Event> PacketDecoder::finish() {
  auto sweep = std::visit([](auto& sweeps) { return sweeps.finish(); }, sweeps_);
  return sweep ? std::optional(event_of(std::move(*sweep), last_)) : std::nullopt;
}

Event PacketDecoder::event_of(Sweep sweep, Nanoseconds received) {
  const std::size_t number = count_++;
  sweep.source = "/points#" + std::to_string(number);
  const bool timed = !sweep.times.empty();
  const bool nanoseconds = sensor_->kind == Kind::ouster || sensor_->kind == Kind::livox;
  return {.topic = kSweeps,
          .received = received,
          .value = std::move(sweep),
          .bytes = std::exchange(bytes_, 0),
          .frame = frame_of(sensor_->kind),
          .point_times = timed ? std::optional(PointTimeNature{.field = "packet time",
                                                               .unit = nanoseconds ? 1e-9 : 1e-6})
                               : std::nullopt,
          .number = number};
}

}  // namespace adit
