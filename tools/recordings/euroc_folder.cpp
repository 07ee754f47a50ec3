// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/euroc_folder.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "adit/tools/recordings/series_recording.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kNumbers = 7;  // numbers in a line behind the time that are read at most

/// The time and the first `needed` numbers behind it.
struct Line {
  Nanoseconds stamp{0};
  std::array<double, kNumbers> v{};
};

Line parse(std::string_view text, std::size_t needed) {
  const std::size_t comma = text.find(',');
  const std::optional<uint64_t> time = parse_unsigned(text.substr(0, comma));
  if (!time || *time > static_cast<uint64_t>(Nanoseconds::max().count())) {
    throw SeriesLineError(in_quotes(text.substr(0, comma)) + " is no time in nanoseconds");
  }
  Line line{.stamp = Nanoseconds(static_cast<int64_t>(*time))};
  std::size_t found = 0;
  for (std::size_t at = comma; at != std::string_view::npos && found < needed;) {
    const std::size_t end = text.find(',', at + 1);
    std::string_view word = text.substr(at + 1, end == std::string_view::npos ? end : end - at - 1);
    word.remove_prefix(std::min(word.find_first_not_of(' '), word.size()));
    const std::optional<double> value = parse_double(word);
    if (!value) {
      throw SeriesLineError(in_quotes(word) + " is no number");
    }
    line.v[found++] = *value;
    at = end;
  }
  if (found < needed) {
    throw SeriesLineError("it has " + std::to_string(found) +
                          " numbers behind the time, expected " + std::to_string(needed));
  }
  return line;
}

EventValue imu_sample(std::string_view text) {
  const auto [stamp, v] = parse(text, 6);
  return ImuSample{stamp, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

EventValue pose(std::string_view text) {
  const auto [stamp, v] = parse(text, 7);
  ReferencePose pose{.stamp = stamp, .parent = "world", .child = "body"};
  pose.T_parent_child = series_pose({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]});
  return pose;
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

/// Either is enough to recognise the folder by.
constexpr std::array kMarks{"imu0", "state_groundtruth_estimate0"};

fs::path base_of(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "mav0", ignored) ? folder / "mav0" : folder;
}

}  // namespace

bool is_euroc_folder(const fs::path& folder) {
  return std::ranges::any_of(kMarks, [&](const char* mark) {
    std::error_code ignored;
    return fs::is_regular_file(base_of(folder) / mark / "data.csv", ignored);
  });
}

std::unique_ptr<Recording> open_euroc_folder(const fs::path& folder) {
  std::vector<EventSeries> series;
  std::error_code error;
  for (fs::directory_iterator entry(base_of(folder), error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const TopicKind kind = kind_of(name);
    const fs::path file = entry->path() / "data.csv";
    std::error_code ignored;
    if (kind != TopicKind::other && fs::is_regular_file(file, ignored)) {
      series.push_back(text_series({"/" + name, "EuRoC CSV", kind, {}}, file,
                                   kind == TopicKind::imu ? imu_sample : pose));
    }
  }
  if (error) {
    throw InputError(folder, {}, "cannot be looked into: " + error.message(),
                     "Check the permissions");
  }
  std::ranges::sort(series, {}, [](const EventSeries& one) { return one.topic.name; });
  const std::string count = std::to_string(series.size());
  return make_series_recording(folder.string() + ": EuRoC folder, " + count + " series",
                               std::move(series));
}

}  // namespace adit
