// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/kitti_raw.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "adit/slam/core/units.hpp"
#include "adit/tools/clouds/sweep_times.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

// Places in a reading, by dataformat.txt.
constexpr std::size_t kLatitude = 0;          // degrees, longitude behind it, then altitude (m)
constexpr std::size_t kRoll = 3;              // rad, pitch and yaw behind it
constexpr std::size_t kAcceleration = 11;     // m/s², body axes
constexpr std::size_t kAngularVelocity = 17;  // rad/s, body axes
constexpr std::size_t kAccuracy = 23;         // m
constexpr std::size_t kPositionMode = 27;
constexpr std::size_t kReadings = 30;

using Reading = std::array<double, kReadings>;

Reading parse(std::string_view line) {
  std::array<std::string_view, kReadings> words;
  if (const std::size_t found = split_words(line, words); found != kReadings) {
    throw SeriesLineError("it has " + std::to_string(found) + " numbers, expected 30");
  }
  Reading reading{};
  for (std::size_t i = 0; i < kReadings; ++i) {
    const std::optional<double> value = parse_double(words[i]);
    if (!value || !std::isfinite(*value)) {
      throw SeriesLineError(in_quotes(words[i]) + " is no number");
    }
    reading[i] = *value;
  }
  if (!(std::abs(reading[kLatitude]) < 89.9 && std::abs(reading[kLatitude + 1]) <= 360.0)) {
    throw SeriesLineError(fmt::format("its latitude and longitude are {:g} and {:g} degrees",
                                      reading[kLatitude], reading[kLatitude + 1]));
  }
  return reading;
}

Eigen::Vector3d vector(const Reading& reading, std::size_t at) {
  return {reading[at], reading[at + 1], reading[at + 2]};
}

/// What the receiver's mode says, by its manufacturer's list.
GnssFixKind kind_of(double mode) {
  switch (static_cast<int>(std::clamp(mode, -1.0, 100.0))) {
    case 0:   // none
    case 1:   // searching
    case 2:   // Doppler
    case 10:  // no data
    case 11:  // blanked
      return GnssFixKind::none;
    case 4:  // differential
    case 5:  // RTK float
    case 6:  // RTK
      return GnssFixKind::ground_augmented;
    case 7:  // WAAS and others
    case 8:  // OmniSTAR
    case 9:
      return GnssFixKind::satellite_augmented;
    default:
      return GnssFixKind::single;
  }
}

/// East, north and up of the Mercator projection, m, at the scale of a latitude (degrees).
Eigen::Vector3d mercator(const Reading& reading, double scale_latitude) {
  constexpr double kEquator = 6378137.0;  // m
  const double scale = std::cos(scale_latitude * kDegree);
  const Eigen::Vector3d g = vector(reading, kLatitude);
  return {scale * kEquator * g.y() * kDegree,
          scale * kEquator * std::log(std::tan((90.0 + g.x()) * kDegree / 2.0)), g.z()};
}

/// Poses in the frame of the first reading's position.
class Poses {
 public:
  ReferencePose operator()(Nanoseconds stamp, std::string_view line) {
    const Reading reading = parse(line);
    if (!first_) {
      first_ = reading;
    }
    const double latitude = (*first_)[kLatitude];
    const Eigen::Vector3d angles = vector(reading, kRoll);
    ReferencePose pose{.stamp = stamp, .parent = "world", .child = "imu"};
    pose.T_parent_child.linear() = (Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
    pose.T_parent_child.translation() = mercator(reading, latitude) - mercator(*first_, latitude);
    return pose;
  }

 private:
  std::optional<Reading> first_;
};

/// One file a reading.
struct Readings {
  std::vector<fs::path> files;
  std::vector<Nanoseconds> stamps;
};

using ReadReading = std::function<EventValue(Nanoseconds, std::string_view line)>;

class ReadingStream final : public EventStream {
 public:
  ReadingStream(const Readings& readings, ReadReading read)
      : readings_(readings), read_(std::move(read)) {}

  std::optional<Event> next() override {
    if (index_ == readings_.files.size()) {
      return std::nullopt;
    }
    const fs::path& file = readings_.files[index_];
    const Nanoseconds stamp = readings_.stamps[index_++];
    const std::string text = read_text_file(file);
    LineReader lines(text);
    try {
      return Event{.topic = 0,
                   .received = stamp,
                   .value = read_(stamp, lines.next().value_or("")),
                   .bytes = text.size(),
                   .frame = "imu"};
    } catch (const SeriesLineError& error) {
      throw InputError(file, Place::line(1), error.what(),
                       "The file is damaged or cut off: copy it again");
    }
  }

 private:
  Readings readings_;
  ReadReading read_;
  std::size_t index_ = 0;
};

Readings list_readings(const fs::path& oxts) {
  Readings readings;
  std::error_code error;
  for (fs::directory_iterator entry(oxts / "data", error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == ".txt") {
      readings.files.push_back(entry->path());
    }
  }
  std::ranges::sort(readings.files, [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  const fs::path times = oxts / "timestamps.txt";
  readings.stamps = read_times(times, TimesOrder::any);
  require_matching_times(times, readings.stamps.size(), readings.files.size(),
                         "readings in " + (oxts / "data").string());
  return readings;
}

/// "R: nine numbers, row by row" and "T: three", m.
std::optional<Eigen::Isometry3d> read_transform(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) {
    return std::nullopt;
  }
  const std::string text = read_text_file(file);
  std::optional<Eigen::Matrix3d> R;
  std::optional<Eigen::Vector3d> t;
  LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    std::array<std::string_view, 10> words;
    const std::size_t count = split_words(*line, words);
    std::array<double, 9> v{};
    bool numbers = count > 1 && count <= words.size();
    for (std::size_t i = 1; i < count && numbers; ++i) {
      const std::optional<double> value = parse_double(words[i]);
      numbers = value.has_value();
      v[i - 1] = value.value_or(0.0);
    }
    if (numbers && words[0] == "R:" && count == 10) {
      R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
    } else if (numbers && words[0] == "T:" && count == 4) {
      t = Eigen::Vector3d(v[0], v[1], v[2]);
    }
  }
  if (!R || !t || !t->allFinite() || !(*R * R->transpose()).isIdentity(1e-3) ||
      R->determinant() < 0.0) {
    throw InputError(file, {}, "it has no rotation R: and translation T:",
                     "Copy the calibration of that day again");
  }
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(*R).normalized().toRotationMatrix();
  T.translation() = *t;
  return T;
}

/// The transforms, at the start of the drive.
class TransformStream final : public EventStream {
 public:
  TransformStream(std::vector<StaticTransform> transforms, Nanoseconds at)
      : transforms_(std::move(transforms)), at_(at) {}

  std::optional<Event> next() override {
    if (index_ == transforms_.size()) {
      return std::nullopt;
    }
    return Event{.topic = 0, .received = at_, .value = transforms_[index_++]};
  }

 private:
  std::vector<StaticTransform> transforms_;
  Nanoseconds at_;
  std::size_t index_ = 0;
};

std::vector<EventSeries> series_of(const fs::path& drive) {
  std::vector<EventSeries> series;
  Nanoseconds first{0};
  std::error_code ignored;
  if (fs::is_regular_file(drive / "oxts" / "timestamps.txt", ignored)) {
    const Readings readings = list_readings(drive / "oxts");
    first = readings.stamps.empty() ? first : readings.stamps.front();
    const auto add = [&](const char* name, TopicKind kind, auto make_read) {
      series.push_back({{name, "KITTI oxts", kind, readings.files.size()},
                        [readings, make_read](const EventSelection&) {
                          return std::make_unique<ReadingStream>(readings, make_read());
                        }});
    };
    add("/oxts/imu", TopicKind::imu, [] { return ReadReading(kitti_imu); });
    add("/oxts/fix", TopicKind::gnss, [] { return ReadReading(kitti_fix); });
    add("/oxts/pose", TopicKind::poses, [] { return ReadReading(Poses()); });
  }
  std::vector<StaticTransform> transforms;
  const fs::path day = fs::absolute(drive / "").lexically_normal().parent_path().parent_path();
  const auto add_transform = [&](const char* file, const char* parent, const char* child) {
    std::optional<Eigen::Isometry3d> T = read_transform(drive / file);
    T = T ? T : read_transform(day / file);
    if (T) {
      transforms.push_back({parent, child, *T});
    }
  };
  add_transform("calib_imu_to_velo.txt", "velodyne", "imu");
  add_transform("calib_velo_to_cam.txt", "cam0", "velodyne");
  if (!transforms.empty()) {
    series.push_back({{"/tf_static", "KITTI calibration", TopicKind::transforms, transforms.size()},
                      [transforms, first](const EventSelection&) {
                        return std::make_unique<TransformStream>(transforms, first);
                      }});
  }
  return series;
}

/// The sweeps, with the name of the sensor's frame.
class SweepStream final : public EventStream {
 public:
  explicit SweepStream(std::unique_ptr<EventStream> events) : events_(std::move(events)) {}

  std::optional<Event> next() override {
    std::optional<Event> event = events_->next();
    if (event) {
      event->frame = "velodyne";
    }
    return event;
  }

 private:
  std::unique_ptr<EventStream> events_;
};

}  // namespace

ImuSample kitti_imu(Nanoseconds stamp, std::string_view line) {
  const Reading reading = parse(line);
  return {stamp, vector(reading, kAngularVelocity), vector(reading, kAcceleration)};
}

GnssFix kitti_fix(Nanoseconds stamp, std::string_view line) {
  const Reading reading = parse(line);
  const double variance = reading[kAccuracy] * reading[kAccuracy];
  GnssFix fix{.stamp = stamp,
              .kind = kind_of(reading[kPositionMode]),
              .latitude = reading[kLatitude],
              .longitude = reading[kLatitude + 1],
              .altitude = reading[kLatitude + 2],
              .covariance = std::nullopt};
  if (variance > 0.0 && std::isfinite(variance)) {
    fix.covariance = Eigen::Vector3d::Constant(variance).asDiagonal();
  }
  return fix;
}

std::unique_ptr<Recording> with_kitti_raw_series(const fs::path& drive,
                                                 std::unique_ptr<Recording> sweeps) {
  std::vector<EventSeries> series = series_of(drive);
  if (series.empty() || sweeps->times_are_assumed()) {
    return sweeps;
  }
  std::string description = sweeps->description();
  for (const EventSeries& one : series) {
    description += "; " + one.topic.name;
  }
  Topic topic = sweeps->topics().front();
  const std::shared_ptr<const Recording> shared = std::move(sweeps);
  series.insert(series.begin(), {std::move(topic), [shared](const EventSelection& selection) {
                                   return std::make_unique<SweepStream>(shared->events(
                                       {.begin = selection.begin,
                                        .end = selection.end,
                                        .point_time_unit = selection.point_time_unit,
                                        .coordinate_scale = selection.coordinate_scale,
                                        .floats_per_point = selection.floats_per_point}));
                                 }});
  return make_series_recording(std::move(description), std::move(series));
}

}  // namespace adit
