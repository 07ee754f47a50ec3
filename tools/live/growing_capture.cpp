// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/growing_capture.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <deque>
#include <fstream>
#include <utility>

#include "adit/tools/live/growth.hpp"
#include "adit/tools/recordings/ordered_packets.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr uint64_t kFileHeader = 24;
constexpr uint64_t kPacketHeader = 16;
constexpr uint32_t kRawIp = 101;  // LINKTYPE_RAW

class GrowingStream final : public EventStream {
 public:
  GrowingStream(const PacketRecorder& recorder, const PacketSensor& sensor,
                EventSelection selection)
      : recorder_(&recorder),
        file_(recorder.path(), std::ios::binary),
        packets_(sensor, true),
        selection_(std::move(selection)),
        reader_(recorder.reserve(), at_) {
    file_.seekg(static_cast<std::streamoff>(kFileHeader));
    if (!file_) {
      throw InputError(recorder.path(), {}, "it cannot be read", "Is it being removed?");
    }
  }

  std::optional<Event> next() override {
    while (ready_.empty() && !ended_) {
      if (const std::optional<CapturedPacket> packet = next_packet()) {
        if (const std::optional<Datagram> datagram = assembly_.take(*packet)) {
          add(packets_.take(*datagram));
        }
      } else {
        ended_ = true;
        add(packets_.flush());
        if (std::optional<Event> last = packets_.finish()) {
          add({std::move(*last)});
        }
      }
    }
    if (ready_.empty()) {
      return std::nullopt;
    }
    Event first = std::move(ready_.front());
    ready_.pop_front();
    return first;
  }

 private:
  /// Waits until the next packet is written; nothing at the end.
  std::optional<CapturedPacket> next_packet() {
    file_.clear();
    if (const uint64_t next = reader_.read(at_); next != at_) {
      at_ = next;  // beyond what the disk has no room for
      file_.seekg(static_cast<std::streamoff>(at_));
    }
    if (!wait_for_growth(*recorder_, at_)) {
      return std::nullopt;
    }
    file_.clear();
    std::array<uint32_t, kPacketHeader / 4> header{};
    file_.read(reinterpret_cast<char*>(header.data()), kPacketHeader);
    packet_.resize(header[2]);
    file_.read(reinterpret_cast<char*>(packet_.data()), static_cast<std::streamsize>(header[2]));
    if (!file_) {
      throw InputError(recorder_->path(), Place::byte(at_), "it ends within a packet",
                       "Another program must not write to it while adit records");
    }
    const uint64_t begin = std::exchange(at_, at_ + kPacketHeader + header[2]);
    return CapturedPacket{.received = std::chrono::seconds(header[0]) + Nanoseconds(header[1]),
                          .link = kRawIp,
                          .bytes = packet_,
                          .offset = begin};
  }

  void add(std::vector<Event> events) {
    for (Event& event : events) {
      if (selection_.topics.empty() || std::ranges::count(selection_.topics, event.topic) > 0) {
        ready_.push_back(std::move(event));
      }
    }
  }

  const PacketRecorder* recorder_;
  std::ifstream file_;
  DatagramAssembly assembly_;
  OrderedPackets packets_;
  EventSelection selection_;
  std::vector<std::byte> packet_;
  uint64_t at_ = kFileHeader;
  DiskReserve::Reader reader_;
  bool ended_ = false;
  std::deque<Event> ready_;
};

}  // namespace

GrowingCapture::GrowingCapture(const PacketRecorder& recorder, PacketSensor sensor,
                               std::vector<Topic> topics)
    : recorder_(&recorder), sensor_(std::move(sensor)), topics_(std::move(topics)) {
  for (Topic& topic : topics_) {
    topic.messages.reset();
  }
}

std::unique_ptr<EventStream> GrowingCapture::events(const EventSelection& selection) const {
  return std::make_unique<GrowingStream>(*recorder_, sensor_, selection);
}

std::string GrowingCapture::description() const {
  return recorder_->path().string() + ": packets of a " + sensor_.name + " as they arrive";
}

}  // namespace adit
