// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/recordings/euroc_folder.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "tools/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestLine = 4096;  // bytes
constexpr std::size_t kNumbers = 7;         // of a line, behind the time, that are read at most

/// One sensor's file.
struct Series {
  fs::path file;
  TopicKind kind = TopicKind::other;
};

/// Walks over the lines of one file.
class SeriesReader {
 public:
  explicit SeriesReader(const Series& series)
      : series_(&series), stream_(series.file, std::ios::binary) {
    if (!stream_) {
      throw InputError(series.file, {}, "cannot be read", "Check its permissions");
    }
  }

  /// The next line's event; nothing at the end. Throws InputError for a line that is none; the call
  /// after that goes on behind it.
  std::optional<EventValue> next() {
    std::array<char, kLongestLine> buffer{};
    while (!stream_.eof()) {
      ++line_;
      stream_.getline(buffer.data(), buffer.size());
      if (stream_.fail() && !stream_.eof()) {
        stream_.setstate(std::ios::eofbit);
        fail("a line of more than " + std::to_string(kLongestLine - 1) + " bytes");
      }
      std::string_view text(buffer.data());
      text = text.substr(0, text.find_last_not_of("\r ") + 1);
      if (!text.empty() && text.front() != '#') {
        return event_of(text);
      }
    }
    return std::nullopt;
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw InputError(series_->file, Place::line(line_), found,
                     "The file is damaged or cut off: copy it again");
  }

  EventValue event_of(std::string_view text) const {
    const std::size_t comma = text.find(',');
    const std::optional<uint64_t> time = parse_unsigned(text.substr(0, comma));
    if (!time || *time > static_cast<uint64_t>(Nanoseconds::max().count())) {
      fail(in_quotes(text.substr(0, comma)) + " is no time in nanoseconds");
    }
    const bool imu = series_->kind == TopicKind::imu;
    const std::size_t needed = imu ? 6 : 7;
    std::array<double, kNumbers> v{};
    std::size_t found = 0;
    for (std::size_t at = comma; at != std::string_view::npos && found < needed;) {
      const std::size_t end = text.find(',', at + 1);
      std::string_view word =
          text.substr(at + 1, end == std::string_view::npos ? end : end - at - 1);
      word.remove_prefix(std::min(word.find_first_not_of(' '), word.size()));
      const std::optional<double> value = parse_double(word);
      if (!value) {
        fail(in_quotes(word) + " is no number");
      }
      v[found++] = *value;
      at = end;
    }
    if (found < needed) {
      fail("it has " + std::to_string(found) + " numbers behind the time, expected " +
           std::to_string(needed));
    }
    const Nanoseconds stamp(static_cast<int64_t>(*time));
    if (imu) {
      return ImuSample{stamp, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
    }
    const Eigen::Quaterniond q(v[3], v[4], v[5], v[6]);
    if (!(q.norm() > 0.5 && q.norm() < 2.0)) {
      fail("its quaternion has the length " + std::to_string(q.norm()) + ", expected 1");
    }
    ReferencePose pose{.stamp = stamp, .parent = "world", .child = "body"};
    pose.T_parent_child.linear() = q.normalized().toRotationMatrix();
    pose.T_parent_child.translation() << v[0], v[1], v[2];
    return pose;
  }

  const Series* series_;
  std::ifstream stream_;
  uint64_t line_ = 0;
};

/// All files at once, the earliest event first.
class EurocStream final : public EventStream {
 public:
  EurocStream(const std::vector<Series>& series, EventSelection selection)
      : selection_(std::move(selection)) {
    for (std::size_t i = 0; i < series.size(); ++i) {
      if (selection_.topics.empty() || std::ranges::count(selection_.topics, i) > 0) {
        heads_.push_back({i, SeriesReader(series[i]), std::nullopt, false});
      }
    }
  }

  std::optional<Event> next() override {
    while (true) {
      Head* first = nullptr;
      for (Head& head : heads_) {
        if (!head.event && !head.ended) {
          head.event = head.reader.next();
          head.ended = !head.event;
        }
        if (head.event && (first == nullptr || stamp(*head.event) < stamp(*first->event))) {
          first = &head;
        }
      }
      if (first == nullptr) {
        return std::nullopt;
      }
      EventValue value = *std::exchange(first->event, std::nullopt);
      const Nanoseconds received = stamp(value);
      if (received < selection_.begin || received > selection_.end) {
        continue;
      }
      if (skipped_ < selection_.skip) {
        ++skipped_;
        continue;
      }
      return Event{.topic = first->topic, .received = received, .value = std::move(value)};
    }
  }

 private:
  struct Head {
    std::size_t topic = 0;
    SeriesReader reader;
    std::optional<EventValue> event;
    bool ended = false;
  };

  static Nanoseconds stamp(const EventValue& value) {
    return stamp_of({.topic = 0, .received = Nanoseconds(0), .value = value});
  }

  EventSelection selection_;
  std::vector<Head> heads_;
  uint64_t skipped_ = 0;
};

/// Lines that are no comments.
uint64_t count_lines(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  uint64_t lines = 0;
  bool at_begin = true;
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

TopicKind kind_of(const std::string& folder) {
  if (folder.starts_with("imu")) {
    return TopicKind::imu;
  }
  for (const char* poses : {"state_groundtruth_estimate", "vicon", "mocap"}) {
    if (folder.starts_with(poses)) {
      return TopicKind::poses;
    }
  }
  return TopicKind::other;
}

class EurocRecording final : public Recording {
 public:
  EurocRecording(const fs::path& folder, std::vector<Series> series)
      : folder_(folder), series_(std::move(series)) {
    for (const Series& one : series_) {
      topics_.push_back({"/" + one.file.parent_path().filename().string(), "EuRoC CSV", one.kind,
                         count_lines(one.file)});
    }
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  bool times_are_assumed() const override { return false; }
  std::unique_ptr<EventStream> events(const EventSelection& selection) const override {
    return std::make_unique<EurocStream>(series_, selection);
  }
  std::string description() const override {
    return folder_.string() + ": EuRoC folder, " + std::to_string(topics_.size()) + " series";
  }

 private:
  fs::path folder_;
  std::vector<Series> series_;
  std::vector<Topic> topics_;
};

fs::path base_of(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "mav0", ignored) ? folder / "mav0" : folder;
}

}  // namespace

bool is_euroc_folder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(base_of(folder) / "imu0" / "data.csv", ignored);
}

std::unique_ptr<Recording> open_euroc_folder(const fs::path& folder) {
  std::vector<Series> series;
  std::error_code error;
  for (fs::directory_iterator entry(base_of(folder), error), end; !error && entry != end;
       entry.increment(error)) {
    const Series one{entry->path() / "data.csv", kind_of(entry->path().filename().string())};
    std::error_code ignored;
    if (one.kind != TopicKind::other && fs::is_regular_file(one.file, ignored)) {
      series.push_back(one);
    }
  }
  if (error) {
    throw InputError(folder, {}, "cannot be looked into: " + error.message(),
                     "Check the permissions");
  }
  std::ranges::sort(series, {}, &Series::file);
  return std::make_unique<EurocRecording>(folder, std::move(series));
}

}  // namespace adit
