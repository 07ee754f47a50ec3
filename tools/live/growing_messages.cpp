// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/growing_messages.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <limits>
#include <utility>

#include "adit/tools/live/growth.hpp"

namespace adit {
namespace {

// A message record of MCAP: opcode, length, channel, sequence, two times.
constexpr uint64_t kRecordHead = 9;
constexpr uint64_t kMessageHead = 22;

template <class T>
T number_at(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

class GrowingMessageStream final : public MessageStream {
 public:
  GrowingMessageStream(const MessageRecorder& recorder, std::optional<uint64_t> end,
                       MessageSelection selection)
      : recorder_(&recorder),
        end_(end),
        selection_(std::move(selection)),
        at_(std::max(selection_.from, recorder.begin())),
        file_(recorder.path(), std::ios::binary),
        reader_(recorder.reserve(), at_) {
    file_.seekg(static_cast<std::streamoff>(at_));
    if (!file_) {
      throw InputError(recorder.path(), {}, "it cannot be read", "Is it being removed?");
    }
  }

  std::optional<RawMessage> next() override {
    while (wait_for_record()) {
      const uint64_t offset = at_;
      const RawMessage message = read_record(offset);
      const bool chosen = selection_.channels.empty() ||
                          std::ranges::count(selection_.channels, message.channel) > 0;
      if (chosen && message.received >= selection_.begin && message.received <= selection_.end) {
        return message;
      }
    }
    return std::nullopt;
  }

 private:
  /// Whether there is another one, now or later.
  bool wait_for_record() {
    go_on();
    return end_ ? at_ < *end_ : wait_for_growth(*recorder_, at_);
  }

  /// Behind what has been read, and beyond what the disk has no room for.
  void go_on() {
    file_.clear();
    if (const uint64_t next = reader_.read(at_); next != at_) {
      at_ = next;
      file_.seekg(static_cast<std::streamoff>(at_));
    }
  }

  RawMessage read_record(uint64_t offset) {
    std::array<std::byte, kRecordHead + kMessageHead> head{};
    file_.read(reinterpret_cast<char*>(head.data()), head.size());
    const auto length = number_at<uint64_t>(head.data() + 1);
    if (!file_ || length < kMessageHead || length > std::numeric_limits<uint32_t>::max()) {
      fail(offset);
    }
    bytes_.resize(length - kMessageHead);
    file_.read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size()));
    if (!file_) {
      fail(offset);
    }
    at_ = offset + kRecordHead + length;
    const std::byte* content = head.data() + kRecordHead;
    return {.channel = number_at<uint16_t>(content),
            .received = Nanoseconds(static_cast<int64_t>(number_at<uint64_t>(content + 6))),
            .bytes = bytes_,
            .offset = offset};
  }

  [[noreturn]] void fail(uint64_t offset) const {
    throw InputError(recorder_->path(), Place::byte(offset), "it holds no whole message there",
                     "Another program must not write to it while adit records");
  }

  const MessageRecorder* recorder_;
  std::optional<uint64_t> end_;  ///< none: waits for more
  MessageSelection selection_;
  uint64_t at_;
  std::ifstream file_;
  DiskReserve::Reader reader_;
  std::vector<std::byte> bytes_;
};

}  // namespace

GrowingMessages::GrowingMessages(const MessageRecorder& recorder)
    : recorder_(&recorder), end_(recorder.committed()) {}

std::unique_ptr<MessageStream> GrowingMessages::messages(const MessageSelection& selection) const {
  return std::make_unique<GrowingMessageStream>(
      *recorder_, waits_ ? std::nullopt : std::optional(end_), selection);
}

}  // namespace adit
