// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/capture_recording.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "adit/tools/packets/ouster_packets.hpp"
#include "adit/tools/packets/velodyne_packets.hpp"
#include "adit/tools/recordings/ordered_packets.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

class CaptureStream final : public EventStream {
 public:
  CaptureStream(const SeekableFile& file, const PacketSensor& sensor, EventSelection selection,
                bool points)
      : file_(&file), capture_(file), packets_(sensor, points), selection_(std::move(selection)) {}

  std::optional<Event> next() override {
    while (ready_.empty()) {
      if (ended_) {
        return std::nullopt;
      }
      read();
    }
    std::variant<Event, InputError> first = std::move(ready_.front());
    ready_.pop_front();
    if (const auto* error = std::get_if<InputError>(&first)) {
      throw InputError(*error);
    }
    return std::get<Event>(std::move(first));
  }

  const PacketOrderCounts& order() const { return packets_.counts(); }
  const DatagramCounts& datagrams() const { return capture_.counts(); }
  std::optional<Nanoseconds> begin() const { return begin_; }  ///< of what was read, as received
  Nanoseconds end() const { return end_; }

 private:
  void read() {
    try {
      const std::optional<Datagram> datagram = capture_.next();
      if (datagram) {
        take(*datagram);
      } else {
        finish();
      }
    } catch (const InputError& error) {
      add(packets_.flush());
      ready_.emplace_back(error);
      finish();
    }
  }

  void take(const Datagram& datagram) {
    begin_ = std::min(begin_.value_or(datagram.received), datagram.received);
    end_ = std::max(end_, datagram.received);
    add(packets_.take(datagram));
  }

  void finish() {
    ended_ = true;
    add(packets_.flush());
    if (std::optional<Event> last = packets_.finish()) {
      add(std::move(*last));
    }
    if (const uint64_t cut = capture_.counts().cut; cut > 0) {
      ready_.emplace_back(InputError(
          file_->path(), {},
          std::to_string(cut) + (cut == 1 ? " packet was" : " packets were") +
              " captured without the end (a snap length shorter than the packets)",
          "What was captured whole is read; capture again with a longer snap length (tcpdump -s "
          "0)"));
    }
  }

  void add(std::vector<Event> events) {
    for (Event& event : events) {
      add(std::move(event));
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
    ready_.emplace_back(std::move(event));
  }

  const SeekableFile* file_;
  PacketCapture capture_;
  OrderedPackets packets_;
  EventSelection selection_;
  std::optional<Nanoseconds> begin_;
  Nanoseconds end_ = Nanoseconds::min();
  uint64_t skipped_ = 0;
  bool ended_ = false;
  std::deque<std::variant<Event, InputError>> ready_;
};

class CaptureRecording final : public Recording {
 public:
  CaptureRecording(const fs::path& path, PacketSensor sensor)
      : file_(path), sensor_(std::move(sensor)), topics_(packet_topics(sensor_)) {
    CaptureStream stream(file_, sensor_, {}, false);
    for (bool more = true; more;) {
      try {
        const std::optional<Event> event = stream.next();
        more = event.has_value();
        if (event) {
          ++*topics_[event->topic].messages;
        }
      } catch (const InputError&) {
        // reported where the events are read
      }
    }
    // Which other packets a sensor may send says nothing about this capture. A gpsd was asked for.
    const std::size_t sent = topics_.size() - (sensor_.gpsd ? 1 : 0);
    for (std::size_t i = PacketDecoder::kSweeps + 1; i < sent; ++i) {
      if (topics_[i].messages == 0U) {
        topics_[i].kind = TopicKind::other;
      }
    }
    order_ = stream.order();
    datagrams_ = stream.datagrams();
    duration_ = stream.begin() ? stream.end() - *stream.begin() : Nanoseconds(0);
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  bool times_are_assumed() const override { return false; }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<CaptureStream>(file_, sensor_, selection, true);
  }
  std::string description() const override {
    const std::string span = std::to_string(seconds(duration_));
    return file_.path().string() + ": capture of a " + sensor_.name + ", " +
           span.substr(0, span.find('.') + 2) + " s, " +
           std::to_string(*topics_[PacketDecoder::kSweeps].messages) + " sweeps on /points";
  }
  std::vector<RecordingNotice> notices() const override {
    std::vector<RecordingNotice> notices = order_notices(order_);
    if (datagrams_.incomplete > 0) {
      notices.push_back(
          {"incomplete_packets",
           std::to_string(datagrams_.incomplete) + " packets lack fragments that were not captured",
           "they are left out", "Check the network between sensor and computer"});
    }
    if (sensor_.angles_of_design) {
      notices.push_back({"angles_of_design",
                         "the angles of its lasers are those of the design of a " + sensor_.name,
                         "those of the sensor differ by some tenths of a degree",
                         "Name its angle correction file with --metadata FILE.csv"});
    }
    return notices;
  }

 private:
  SeekableFile file_;
  PacketSensor sensor_;
  std::vector<Topic> topics_;
  PacketOrderCounts order_;
  DatagramCounts datagrams_;
  Nanoseconds duration_{0};
};

/// What the metadata are of; nothing where there are none.
struct Metadata {
  fs::path file{};
  std::optional<OusterSensor> ouster{};
  std::optional<HesaiAngles> hesai{};
};
Metadata read_metadata(const fs::path& capture, const fs::path& named) {
  Metadata metadata{.file = named.empty() ? find_ouster_metadata(capture) : named};
  if (metadata.file.empty()) {
    return metadata;
  }
  if (metadata.file.extension() == ".json") {
    metadata.ouster = read_ouster_sensor(metadata.file);
  } else {
    metadata.hesai = read_hesai_angles(metadata.file);
  }
  return metadata;
}

/// What was seen among the first packets.
struct Seen {
  std::set<std::pair<uint32_t, uint16_t>> senders;
  std::map<std::size_t, int> sizes;
  bool ouster = false;
  bool livox = false;
  bool other_velodyne = false;
  bool gpsd = false;
  std::string velodyne;
  std::optional<HesaiPacket> hesai;
  DatagramCounts datagrams;

  void look_at(const Datagram& datagram, const Metadata& metadata) {
    if (!gpsd_line(datagram).empty()) {
      gpsd = true;
      return;
    }
    ++sizes[datagram.sent()];
    if (metadata.ouster && is_ouster_data(datagram, *metadata.ouster)) {
      ouster = true;
    } else if (is_velodyne_data(datagram)) {
      const std::optional<std::string> model = velodyne_model(datagram);
      other_velodyne = other_velodyne || !model;
      velodyne = model ? "Velodyne " + *model : velodyne;
    } else if (const auto packet = hesai_packet(datagram)) {
      hesai = packet;
    } else if (is_livox_data(datagram)) {
      livox = true;
    } else {
      return;
    }
    senders.insert({datagram.source, datagram.port});
  }
};

[[noreturn]] void fail_unknown(const fs::path& path, const Seen& seen, const Metadata& metadata) {
  std::string found = "it holds no packets of a sensor that is known";
  std::string remedy =
      "Velodyne VLP-16, Puck Hi-Res, HDL-32E, VLP-32C and VLS-128, Hesai (PandarXT, XT32M2X, "
      "Pandar40P, Pandar64, PandarQT64, QT128C2X, OT128, Pandar128), Livox Mid-360 and HAP are "
      "read, and Ouster sensors whose metadata lie beside the capture as " +
      path.stem().string() + ".json or are named with --metadata";
  if (seen.datagrams.cut > 0) {
    found = std::to_string(seen.datagrams.cut) +
            " of its packets were captured without the end (a snap length shorter than the "
            "packets), and the rest are of no sensor that is known";
    remedy = "Capture again with a longer snap length (tcpdump -s 0)";
  } else if (seen.other_velodyne) {
    found = "its Velodyne is none of those that are read";
  } else if (!seen.sizes.empty()) {
    const auto usual =
        std::ranges::max_element(seen.sizes, {}, [](const auto& entry) { return entry.second; });
    found += "; the usual datagram has " + std::to_string(usual->first) + " bytes";
  } else if (!seen.datagrams.unread_links.empty()) {
    const auto& [link, packets] = *seen.datagrams.unread_links.begin();
    found += ": its " + std::to_string(packets) + " packets are of the link layer " +
             std::to_string(link) + " (LINKTYPE), which is not read";
    remedy = "Capture on an Ethernet interface, or on the device \"any\"";
  }
  if (metadata.ouster && seen.datagrams.cut == 0) {
    remedy = metadata.file.filename().string() + " describes packets of " +
             std::to_string(metadata.ouster->packet_bytes()) +
             " bytes: is it of this sensor, in this mode?";
  }
  throw InputError(path, {}, found, remedy);
}

/// The sensor of which that was seen.
PacketSensor sensor_seen(const fs::path& path, const Seen& seen, Metadata metadata) {
  if (seen.senders.size() > 1) {
    throw InputError(
        path, {},
        "it holds the packets of " + std::to_string(seen.senders.size()) + " range sensors",
        "Keep one of them, for example with Wireshark's filter udp.port");
  }
  if (seen.ouster) {
    return ouster_packets_of(std::move(*metadata.ouster));
  }
  if (!seen.velodyne.empty()) {
    return {.name = seen.velodyne, .kind = PacketSensor::Kind::velodyne};
  }
  if (seen.livox) {
    return {.name = "Livox", .kind = PacketSensor::Kind::livox};
  }
  if (seen.hesai) {
    const std::optional<HesaiAngles> angles =
        metadata.hesai ? metadata.hesai : hesai_angles_by_design(*seen.hesai);
    if (!angles) {
      throw InputError(path, {},
                       "it is of a Hesai " + seen.hesai->model +
                           ", whose lasers point differently in each sensor",
                       "Name its angle correction file with --metadata FILE.csv");
    }
    const bool of_design = !metadata.hesai && seen.hesai->times->each_has_its_own;
    return {.name = "Hesai " + seen.hesai->model,
            .kind = PacketSensor::Kind::hesai,
            .hesai = *angles,
            .angles_of_design = of_design};
  }
  fail_unknown(path, seen, metadata);
}

/// Looks at the first packets. Damage ends the look, and is reported where the events are read.
PacketSensor recognise(const fs::path& path, const fs::path& named) {
  constexpr int kPackets = 20000;
  Metadata metadata = read_metadata(path, named);
  const SeekableFile file(path);
  PacketCapture capture(file);
  Seen seen;
  try {
    for (int i = 0; i < kPackets; ++i) {
      const std::optional<Datagram> datagram = capture.next();
      if (!datagram) {
        break;
      }
      seen.look_at(*datagram, metadata);
    }
  } catch (const InputError&) {
    // what was found so far counts
  }
  seen.datagrams = capture.counts();
  PacketSensor sensor = sensor_seen(path, seen, std::move(metadata));
  sensor.gpsd = seen.gpsd;
  return sensor;
}

}  // namespace

std::unique_ptr<Recording> open_packet_capture(const fs::path& path, const fs::path& metadata) {
  return std::make_unique<CaptureRecording>(path, recognise(path, metadata));
}

PacketSensor sensor_of_capture(const fs::path& path, const fs::path& metadata) {
  return recognise(path, metadata);
}

}  // namespace adit
