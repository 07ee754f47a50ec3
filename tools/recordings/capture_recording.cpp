// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/capture_recording.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "adit/tools/packets/ouster_packets.hpp"
#include "adit/tools/packets/velodyne_packets.hpp"
#include "adit/tools/recordings/packet_decoder.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

class CaptureStream final : public EventStream {
 public:
  CaptureStream(const SeekableFile& file, const PacketSensor& sensor, EventSelection selection,
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
  PacketDecoder decoder_;
  EventSelection selection_;
  uint64_t skipped_ = 0;
  bool ended_ = false;
  std::deque<Event> ready_;
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
           std::to_string(*topics_[PacketDecoder::kSweeps].messages) + " sweeps on /points";
  }

 private:
  SeekableFile file_;
  PacketSensor sensor_;
  std::vector<Topic> topics_;
  std::optional<Nanoseconds> begin_;
  Nanoseconds end_{0};
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
  std::string velodyne;
  std::optional<HesaiPacket> hesai;

  void look_at(const Datagram& datagram, const Metadata& metadata) {
    ++sizes[datagram.payload.size()];
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
  if (seen.other_velodyne) {
    found = "its Velodyne is no VLP-16 or HDL-32E";
  } else if (!seen.sizes.empty()) {
    const auto usual =
        std::ranges::max_element(seen.sizes, {}, [](const auto& entry) { return entry.second; });
    found += "; the usual datagram has " + std::to_string(usual->first) + " bytes";
  }
  throw InputError(path, {}, found,
                   metadata.ouster
                       ? metadata.file.filename().string() + " describes packets of " +
                             std::to_string(metadata.ouster->packet_bytes()) +
                             " bytes: is it of this sensor, in this mode?"
                       : "Velodyne VLP-16 and HDL-32E, Hesai, Livox Mid-360 and HAP are read, and "
                         "Ouster sensors whose metadata lie beside the capture as " +
                             path.stem().string() + ".json or are named with --metadata");
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
    return {
        .name = "Hesai " + seen.hesai->model, .kind = PacketSensor::Kind::hesai, .hesai = *angles};
  }
  fail_unknown(path, seen, metadata);
}

}  // namespace

std::unique_ptr<Recording> open_packet_capture(const fs::path& path, const fs::path& metadata) {
  return std::make_unique<CaptureRecording>(path, recognise(path, metadata));
}

}  // namespace adit
