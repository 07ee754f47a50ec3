// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/tum_folder.hpp"

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/clouds/depth_camera.hpp"
#include "adit/tools/clouds/depth_png.hpp"
#include "adit/tools/recordings/series_recording.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr float kMetresPerStep = 1.0F / 5000.0F;

Nanoseconds time_of(std::string_view word) {
  const std::optional<Nanoseconds> time = parse_seconds(word);
  if (!time) {
    throw SeriesLineError(in_quotes(word) + " is no time in seconds");
  }
  return *time;
}

/// The time and `count` numbers behind it.
template <std::size_t count>
std::pair<Nanoseconds, std::array<double, count>> numbers(std::string_view line) {
  std::array<std::string_view, count + 1> words;
  if (const std::size_t found = split_words(line, words); found < words.size()) {
    throw SeriesLineError("it has " + std::to_string(found) + " words, expected " +
                          std::to_string(words.size()));
  }
  std::array<double, count> values{};
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<double> value = parse_double(words[i + 1]);
    if (!value) {
      throw SeriesLineError(in_quotes(words[i + 1]) + " is no number");
    }
    values[i] = *value;
  }
  return {time_of(words[0]), values};
}

EventValue pose(std::string_view line) {
  const auto [stamp, v] = numbers<7>(line);
  ReferencePose pose{.stamp = stamp, .parent = "world", .child = "camera"};
  pose.T_parent_child = series_pose({v[0], v[1], v[2]}, {v[6], v[3], v[4], v[5]});
  return pose;
}

EventValue acceleration(std::string_view line) {
  const auto [stamp, v] = numbers<3>(line);
  return ImuSample{
      .stamp = stamp,
      .angular_velocity = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()),
      .linear_acceleration = {v[0], v[1], v[2]}};
}

CameraModel read_calibration(const fs::path& folder) {
  CameraModel model{
      .width = 640, .height = 480, .fx = 525.0, .fy = 525.0, .cx = 319.5, .cy = 239.5};
  const fs::path file = folder / "calibration.txt";
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    return model;
  }
  const std::string text = read_text_file(file);
  std::array<std::string_view, 4> words;
  LineReader lines(text);
  const std::size_t count = split_words(lines.next().value_or(""), words);
  std::array<double, 4> v{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    v[i] = count == words.size() ? parse_double(words[i]).value_or(0.0) : 0.0;
  }
  if (!(v[0] > 1.0 && v[0] < 1e6 && v[1] > 1.0 && v[1] < 1e6 && v[2] > 0.0 && v[2] < 1e6 &&
        v[3] > 0.0 && v[3] < 1e6)) {
    throw InputError(file, Place::line(1), "it is no calibration",
                     "Expected fx fy cx cy in pixels, such as 525.0 525.0 319.5 239.5");
  }
  model.fx = v[0];
  model.fy = v[1];
  model.cx = v[2];
  model.cy = v[3];
  return model;
}

/// The images that depth.txt names.
class DepthStream final : public EventStream {
 public:
  DepthStream(const fs::path& folder, const CameraModel& model, const EventSelection& selection)
      : folder_(folder), model_(model), begin_(selection.begin), end_(selection.end) {
    EventSeries names = text_series({}, folder / "depth.txt", [this](std::string_view line) {
      std::array<std::string_view, 2> words;
      if (split_words(line, words) != words.size()) {
        throw SeriesLineError("expected a time and a file");
      }
      name_ = words[1];
      Sweep sweep;
      sweep.stamp = time_of(words[0]);
      return sweep;
    });
    lines_ = names.open({});
  }

  std::optional<Event> next() override {
    while (std::optional<Event> event = lines_->next()) {
      if (event->received >= begin_ && event->received <= end_) {
        read(*event);
        return event;
      }
    }
    return std::nullopt;
  }

 private:
  void read(Event& event) {
    const fs::path file = folder_ / name_;
    const std::string content = read_whole_file(file);
    const DepthPng image = parse_depth_png(file, content);
    if (!camera_ || camera_->model().width != image.width ||
        camera_->model().height != image.height) {
      model_.width = image.width;
      model_.height = image.height;
      camera_.emplace(model_);
    }
    std::vector<float> depths(image.values.size());
    for (std::size_t i = 0; i < depths.size(); ++i) {
      depths[i] = kMetresPerStep * static_cast<float>(image.values[i]);
    }
    auto& sweep = std::get<Sweep>(event.value);
    sweep.points = camera_->points(depths);
    sweep.source = file.string();
    event.bytes = content.size();
    event.frame = "camera";
  }

  fs::path folder_;
  CameraModel model_;
  Nanoseconds begin_;
  Nanoseconds end_;
  std::string name_;  // name in the last line
  std::unique_ptr<EventStream> lines_;
  std::optional<DepthCamera> camera_;
};

}  // namespace

bool is_tum_folder(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "depth.txt", ignored);
}

std::unique_ptr<Recording> open_tum_folder(const fs::path& folder) {
  const CameraModel model = read_calibration(folder);
  std::vector<EventSeries> series;
  // Counts the images; the stream that reads them is another.
  series.push_back(
      text_series({"/depth", "TUM RGB-D PNG", TopicKind::sweeps, {}}, folder / "depth.txt", pose));
  series.back().open = [folder, model](const EventSelection& selection) {
    return std::make_unique<DepthStream>(folder, model, selection);
  };
  const auto add = [&](const char* name, const char* file, TopicKind kind, ReadLine read) {
    std::error_code ignored;
    if (fs::is_regular_file(folder / file, ignored)) {
      series.push_back(text_series({name, "TUM text", kind, {}}, folder / file, std::move(read)));
    }
  };
  add("/accelerometer", "accelerometer.txt", TopicKind::imu, acceleration);
  add("/groundtruth", "groundtruth.txt", TopicKind::poses, pose);
  const std::string camera =
      fmt::format("focal lengths {:.1f}, {:.1f}, centre {:.1f}, {:.1f} pixels", model.fx, model.fy,
                  model.cx, model.cy);
  const std::string images = std::to_string(series.front().topic.messages.value_or(0));
  return make_series_recording(
      folder.string() + ": TUM RGB-D folder, " + images + " depth images, " + camera,
      std::move(series));
}

}  // namespace adit
