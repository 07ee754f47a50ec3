// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/series_recording.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>
#include <utility>

#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = 4096;  // bytes

/// All series at once, the earliest event first.
class SeriesStream final : public EventStream {
 public:
  SeriesStream(const std::vector<EventSeries>& series, EventSelection selection)
      : selection_(std::move(selection)) {
    for (std::size_t i = 0; i < series.size(); ++i) {
      if (selection_.topics.empty() || std::ranges::count(selection_.topics, i) > 0) {
        heads_.push_back({i, series[i].open(selection_), std::nullopt, false});
      }
    }
  }

  std::optional<Event> next() override {
    while (true) {
      Head* first = nullptr;
      for (Head& head : heads_) {
        if (!head.event && !head.ended) {
          head.event = head.stream->next();
          head.ended = !head.event;
        }
        if (head.event && (first == nullptr || head.event->received < first->event->received)) {
          first = &head;
        }
      }
      if (first == nullptr) {
        return std::nullopt;
      }
      Event event = std::move(*std::exchange(first->event, std::nullopt));
      if (event.received < selection_.begin || event.received > selection_.end) {
        continue;
      }
      if (skipped_ < selection_.skip) {
        ++skipped_;
        continue;
      }
      event.topic = first->topic;
      return event;
    }
  }

 private:
  struct Head {
    std::size_t topic = 0;
    std::unique_ptr<EventStream> stream;
    std::optional<Event> event;
    bool ended = false;
  };

  EventSelection selection_;
  std::vector<Head> heads_;
  uint64_t skipped_ = 0;
};

class SeriesRecording final : public Recording {
 public:
  SeriesRecording(std::string description, std::vector<EventSeries> series)
      : description_(std::move(description)), series_(std::move(series)) {
    for (const EventSeries& one : series_) {
      topics_.push_back(one.topic);
    }
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  bool times_are_assumed() const override { return false; }
  std::string description() const override { return description_; }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<SeriesStream>(series_, selection);
  }

 private:
  std::string description_;
  std::vector<EventSeries> series_;
  std::vector<Topic> topics_;
};

/// Walks over the lines of one file.
class LineStream final : public EventStream {
 public:
  LineStream(const fs::path& file, ReadLine read, uint64_t header)
      : file_(file), read_(std::move(read)), stream_(open_text_file(file)), header_(header) {}

  std::optional<Event> next() override {
    std::array<char, kLongestLine> buffer{};
    while (!stream_.eof()) {
      ++line_;
      stream_.getline(buffer.data(), buffer.size());
      const auto bytes = static_cast<uint64_t>(stream_.gcount());
      if (stream_.fail() && !stream_.eof()) {
        stream_.setstate(std::ios::eofbit);
        fail("a line of more than " + std::to_string(kLongestLine - 1) + " bytes");
      }
      std::string_view text(buffer.data());
      text = text.substr(0, text.find_last_not_of("\r \t") + 1);
      if (text.empty() || text.front() == '#' || line_ <= header_) {
        continue;
      }
      try {
        Event event{.topic = 0, .received = Nanoseconds(0), .value = read_(text), .bytes = bytes};
        event.received = stamp_of(event);
        return event;
      } catch (const SeriesLineError& error) {
        fail(error.what());
      }
    }
    return std::nullopt;
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw InputError(file_, Place::line(line_), found,
                     "The file is damaged or cut off: copy it again");
  }

  fs::path file_;
  ReadLine read_;
  std::ifstream stream_;
  uint64_t header_;  // lines
  uint64_t line_ = 0;
};

/// Lines after the header that are no comments.
uint64_t count_lines(const fs::path& file, uint64_t header) {
  std::ifstream stream = open_text_file(file);
  uint64_t lines = 0;
  bool at_begin = true;
  for (std::string line; header > 0 && std::getline(stream, line);) {
    --header;
  }
  for (std::array<char, 65536> buffer{}; stream;) {
    stream.read(buffer.data(), buffer.size());
    for (std::streamsize i = 0; i < stream.gcount(); ++i) {
      const char c = buffer[static_cast<std::size_t>(i)];
      lines += at_begin && c != '#' && c != '\n' && c != '\r' ? 1U : 0U;
      at_begin = c == '\n';
    }
  }
  return lines;
}

}  // namespace

std::unique_ptr<Recording> make_series_recording(std::string description,
                                                 std::vector<EventSeries> series) {
  return std::make_unique<SeriesRecording>(std::move(description), std::move(series));
}

Eigen::Isometry3d series_pose(const Eigen::Vector3d& position, const std::array<double, 4>& wxyz) {
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  const double length = q.norm();
  if (!(length > 0.5 && length < 2.0)) {
    const std::string told =
        length < 1e3 ? "length " + std::to_string(length) : "length of more than 1000";
    throw SeriesLineError("its quaternion has the " + told + ", expected 1");
  }
  if (!is_position(position)) {
    throw SeriesLineError("its position is not finite, or beyond 1e12 m");
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = position;
  return pose;
}

EventSeries text_series(Topic topic, const fs::path& file, ReadLine read, uint64_t header) {
  topic.messages = count_lines(file, header);
  return {std::move(topic), [file, header, read = std::move(read)](const EventSelection&) {
            return std::make_unique<LineStream>(file, read, header);
          }};
}

}  // namespace adit
