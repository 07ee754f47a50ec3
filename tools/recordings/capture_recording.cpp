// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/capture_recording.hpp"

#include <algorithm>
#include <deque>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "adit/tools/packets/ouster_packets.hpp"
#include "adit/tools/packets/velodyne_packets.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSweeps = 0;  // topics
constexpr std::size_t kSecond = 1;  // Velodyne: GNSS; Ouster: IMU
constexpr std::size_t kTransforms = 2;

/// What the packets come from.
struct Sensor {
  std::string name;                    ///< for people
  std::optional<OusterSensor> ouster;  ///< none: a Velodyne
};

/// From datagrams to events.
class Decoder {
 public:
  Decoder(const Sensor& sensor, bool points) : sensor_(&sensor) {
    if (sensor.ouster) {
      sweeps_.emplace<OusterSweeps>(*sensor.ouster, points);
    } else {
      sweeps_.emplace<VelodyneSweeps>(points);
    }
  }

  /// Nothing as a rule: it takes many packets to make a sweep.
  std::vector<Event> take(const Datagram& datagram) {
    std::vector<Event> events;
    if (sensor_->ouster && !told_) {
      told_ = true;
      for (const auto& [child, T] : {std::pair{"os_lidar", sensor_->ouster->T_sensor_lidar},
                                     std::pair{"os_imu", sensor_->ouster->T_sensor_imu}}) {
        events.push_back({.topic = kTransforms,
                          .received = datagram.received,
                          .value = StaticTransform{"os_sensor", child, T}});
      }
    }
    if (sensor_->ouster ? is_ouster_data(datagram, *sensor_->ouster) : is_velodyne_data(datagram)) {
      bytes_ += datagram.payload.size();
      auto whole = std::visit([&](auto& sweeps) { return sweeps.take(datagram); }, sweeps_);
      for (Sweep& sweep : whole) {
        events.push_back(event_of(std::move(sweep), datagram.received));
      }
      last_ = datagram.received;
    } else if (sensor_->ouster && is_ouster_imu(datagram)) {
      events.push_back({.topic = kSecond,
                        .received = datagram.received,
                        .value = ouster_imu(datagram),
                        .bytes = datagram.payload.size(),
                        .frame = "os_imu"});
    } else if (!sensor_->ouster && is_velodyne_position(datagram)) {
      const std::optional<GnssFix> fix = velodyne_fix(datagram);
      if (fix && fix->stamp != last_fix_) {  // a sentence is repeated until the next
        last_fix_ = fix->stamp;
        events.push_back({.topic = kSecond,
                          .received = datagram.received,
                          .value = *fix,
                          .bytes = datagram.payload.size()});
      }
    }
    return events;
  }

  std::optional<Event> finish() {
    auto sweep = std::visit([](auto& sweeps) { return sweeps.finish(); }, sweeps_);
    return sweep ? std::optional(event_of(std::move(*sweep), last_)) : std::nullopt;
  }

 private:
  Event event_of(Sweep sweep, Nanoseconds received) {
    sweep.source = "/points#" + std::to_string(count_++);
    const bool timed = !sweep.times.empty();
    return {.topic = kSweeps,
            .received = received,
            .value = std::move(sweep),
            .bytes = std::exchange(bytes_, 0),
            .frame = sensor_->ouster ? "os_lidar" : "velodyne",
            .point_times = timed
                               ? std::optional(PointTimeNature{
                                     .field = "packet time", .unit = sensor_->ouster ? 1e-9 : 1e-6})
                               : std::nullopt};
  }

  const Sensor* sensor_;
  std::variant<VelodyneSweeps, OusterSweeps> sweeps_;
  bool told_ = false;
  uint64_t bytes_ = 0;
  uint64_t count_ = 0;
  Nanoseconds last_{0};
  std::optional<Nanoseconds> last_fix_;
};

class CaptureStream final : public EventStream {
 public:
  CaptureStream(const SeekableFile& file, const Sensor& sensor, EventSelection selection,
                bool points)
      : capture_(file), decoder_(sensor, points), selection_(std::move(selection)) {}

  std::optional<Event> next() override {
    while (true) {
      if (!ready_.empty()) {
        Event event = std::move(ready_.front());
        ready_.pop_front();
        return event;
      }
      if (ended_) {
        return std::nullopt;
      }
      read();
    }
  }

 private:
  void read() {
    std::optional<Datagram> datagram;
    try {
      datagram = capture_.next();
    } catch (const InputError&) {
      end();
      throw;
    }
    if (!datagram) {
      end();
      return;
    }
    for (Event& event : decoder_.take(*datagram)) {
      add(std::move(event));
    }
  }

  void end() {
    ended_ = true;
    if (std::optional<Event> last = decoder_.finish()) {
      add(std::move(*last));
    }
  }

  void add(Event event) {
    const bool chosen =
        selection_.topics.empty() || std::ranges::count(selection_.topics, event.topic) > 0;
    if (!chosen || event.received < selection_.begin || event.received > selection_.end) {
      return;
    }
    if (skipped_ < selection_.skip) {
      ++skipped_;
      return;
    }
    ready_.push_back(std::move(event));
  }

  PacketCapture capture_;
  Decoder decoder_;
  EventSelection selection_;
  uint64_t skipped_ = 0;
  bool ended_ = false;
  std::deque<Event> ready_;
};

class CaptureRecording final : public Recording {
 public:
  CaptureRecording(const fs::path& path, Sensor sensor) : file_(path), sensor_(std::move(sensor)) {
    const bool ouster = sensor_.ouster.has_value();
    topics_ = {{"/points", sensor_.name + " packets", TopicKind::sweeps, 0},
               {ouster ? "/imu" : "/fix", sensor_.name + (ouster ? " packets" : " NMEA"),
                ouster ? TopicKind::imu : TopicKind::gnss, 0}};
    if (ouster) {
      topics_.push_back({"/tf_static", "Ouster metadata", TopicKind::transforms, 0});
    }
    CaptureStream stream(file_, sensor_, {}, false);
    for (bool more = true; more;) {
      try {
        const std::optional<Event> event = stream.next();
        more = event.has_value();
        if (event) {
          ++*topics_[event->topic].messages;
          end_ = event->received;
          begin_ = begin_.value_or(event->received);
        }
      } catch (const InputError&) {
        // reported where the events are read
      }
    }
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  bool times_are_assumed() const override { return false; }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<CaptureStream>(file_, sensor_, selection, true);
  }
  std::string description() const override {
    const std::chrono::duration<double> span = end_ - begin_.value_or(end_);
    const std::string seconds = std::to_string(span.count());
    return file_.path().string() + ": capture of a " + sensor_.name + ", " +
           seconds.substr(0, seconds.find('.') + 2) + " s, " +
           std::to_string(*topics_[kSweeps].messages) + " sweeps on /points";
  }

 private:
  SeekableFile file_;
  Sensor sensor_;
  std::vector<Topic> topics_;
  std::optional<Nanoseconds> begin_;
  Nanoseconds end_{0};
};

/// Looks at the first packets. Damage ends the look, and is reported where the events are read.
Sensor recognise(const fs::path& path) {
  constexpr int kPackets = 20000;
  const fs::path metadata = find_ouster_metadata(path);
  std::optional<OusterSensor> ouster;
  if (!metadata.empty()) {
    ouster = read_ouster_sensor(metadata);
  }
  const SeekableFile file(path);
  PacketCapture capture(file);
  std::set<std::pair<uint32_t, uint16_t>> senders;
  std::string name;
  bool other_velodyne = false;
  bool is_ouster = false;
  std::map<std::size_t, int> sizes;
  try {
    for (int i = 0; i < kPackets; ++i) {
      const std::optional<Datagram> datagram = capture.next();
      if (!datagram) {
        break;
      }
      ++sizes[datagram->payload.size()];
      if (ouster && is_ouster_data(*datagram, *ouster)) {
        is_ouster = true;
      } else if (is_velodyne_data(*datagram)) {
        const std::optional<std::string> model = velodyne_model(*datagram);
        other_velodyne = other_velodyne || !model;
        name = model ? "Velodyne " + *model : name;
      } else {
        continue;
      }
      senders.insert({datagram->source, datagram->port});
    }
  } catch (const InputError&) {
    // what was found so far counts
  }
  if (senders.size() > 1) {
    throw InputError(path, {},
                     "it holds the packets of " + std::to_string(senders.size()) + " range sensors",
                     "Keep one of them, for example with Wireshark's filter udp.port");
  }
  if (is_ouster) {
    return {"Ouster with " + std::to_string(ouster->beams) + " beams", std::move(ouster)};
  }
  if (!name.empty()) {
    return {name, std::nullopt};
  }
  std::string found = "it holds no packets of a sensor that is known";
  if (other_velodyne) {
    found = "its Velodyne is no VLP-16 or HDL-32E";
  } else if (!sizes.empty()) {
    const auto usual =
        std::ranges::max_element(sizes, {}, [](const auto& entry) { return entry.second; });
    found += "; the usual datagram has " + std::to_string(usual->first) + " bytes";
  }
  throw InputError(path, {}, found,
                   metadata.empty()
                       ? "Velodyne VLP-16 and HDL-32E are read, and Ouster sensors whose metadata "
                         "lie beside the capture as " +
                             path.stem().string() + ".json"
                       : metadata.filename().string() + " describes packets of " +
                             std::to_string(ouster->packet_bytes()) +
                             " bytes: is it of this sensor, in this mode?");
}

}  // namespace

std::unique_ptr<Recording> open_packet_capture(const fs::path& path) {
  return std::make_unique<CaptureRecording>(path, recognise(path));
}

}  // namespace adit
