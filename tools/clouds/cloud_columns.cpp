// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/cloud_columns.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

#include <fmt/core.h>

#include "adit/tools/clouds/cloud_origin.hpp"
#include "adit/tools/clouds/column_values.hpp"
#include "adit/tools/clouds/returns.hpp"

namespace adit {
namespace {

/// A double beyond float's range becomes infinity, which counts as no return.
template <class T>
float to_float(T value) {
  if constexpr (std::is_same_v<T, double>) {
    if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
      return value > 0.0 ? std::numeric_limits<float>::infinity()
                         : -std::numeric_limits<float>::infinity();
    }
  }
  return static_cast<float>(value);
}

/// Points that a field of theirs shows to be damaged. They are left out where they are few.
struct BadPoints {
  std::vector<std::size_t> indices{};
  std::string found{};  ///< of the first, for people
};

void leave_out(const std::filesystem::path& file, const BadPoints& bad, CloudFile& cloud) {
  if (bad.indices.empty()) {
    return;
  }
  for (const std::size_t i : bad.indices) {
    Point& point = cloud.sweep.points[i];
    point.x = point.y = point.z = std::numeric_limits<float>::quiet_NaN();
  }
  const std::size_t count = bad.indices.size();
  cloud.faults.emplace_back(
      file, Place::point(bad.indices.front()),
      bad.found + fmt::format("; {} of {} points {} so and left out", count,
                              cloud.sweep.points.size(), count == 1 ? "is" : "are"),
      "The file is damaged there; its other points are read");
}

/// Throws InputError where many rings are no beam numbers.
BadPoints decode_rings(const std::filesystem::path& file, const Column& column,
                       std::vector<uint16_t>& rings) {
  BadPoints bad;
  for_each_value(column, rings.size(), [&](std::size_t i, auto value) {
    const auto number = static_cast<double>(value);
    if (number >= 0.0 && number <= 65535.0) {
      rings[i] = static_cast<uint16_t>(number);
      return;
    }
    if (bad.indices.empty()) {
      bad.found = fmt::format("its ring is {:g}, not a beam number of 0 to 65535", number);
    }
    bad.indices.push_back(i);
  });
  if (!are_few(bad.indices.size(), rings.size())) {
    throw InputError(file, Place::point(bad.indices.front()), bad.found,
                     "The file is damaged, or the field means something else: rename it");
  }
  return bad;
}

/// The times of points, and those of them that cannot be true.
struct DecodedTimes {
  PointTimes times;
  BadPoints bad;
};

/// `valid` loses the points whose times are impossible.
template <class T>
DecodedTimes understood(const std::filesystem::path& file, const std::vector<T>& times,
                        std::vector<uint8_t> valid, bool single_precision,
                        const CloudReading& reading) {
  DecodedTimes decoded;
  decoded.bad.indices = impossible_times(std::span<const T>(times), valid, reading.time_unit);
  for (const std::size_t i : decoded.bad.indices) {
    valid[i] = 0;
  }
  if (!decoded.bad.indices.empty()) {
    const auto time = static_cast<double>(times[decoded.bad.indices.front()]);
    decoded.bad.found =
        std::isfinite(time)
            ? fmt::format("its time is {:g}, far from those of the other points", time)
            : std::string("its time is no number");
  }
  if constexpr (std::is_floating_point_v<T>) {
    decoded.times =
        interpret_times(file, times, valid, single_precision, reading.time_unit, reading.longest);
  } else {
    decoded.times = interpret_times(file, times, valid, reading.time_unit, reading.longest);
  }
  return decoded;
}

/// Times as integers or doubles, whichever the column holds; 64-bit integers do not pass through a
/// double.
DecodedTimes decode_times(const std::filesystem::path& file, const Column& column,
                          const CloudReading& reading, const std::vector<uint8_t>& valid) {
  const bool floating = column.type == ScalarType::f32 || column.type == ScalarType::f64;
  if (floating) {
    std::vector<double> times(valid.size());
    for_each_value(column, valid.size(),
                   [&](std::size_t i, auto value) { times[i] = static_cast<double>(value); });
    return understood(file, times, valid, column.type == ScalarType::f32, reading);
  }
  std::vector<int64_t> times(valid.size());
  for_each_value(column, valid.size(), [&](std::size_t i, auto value) {
    if constexpr (std::is_same_v<decltype(value), uint64_t>) {
      constexpr auto kMost = static_cast<uint64_t>(std::numeric_limits<int64_t>::max());
      times[i] = static_cast<int64_t>(std::min(value, kMost));
    } else if constexpr (std::is_integral_v<decltype(value)>) {
      times[i] = static_cast<int64_t>(value);
    }
  });
  return understood(file, times, valid, false, reading);
}

/// Lower case, without CloudCompare's prefix.
std::string plain_name(std::string_view name) {
  std::string plain(name);
  std::transform(plain.begin(), plain.end(), plain.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::string_view kPrefix = "scalar_";
  return plain.starts_with(kPrefix) ? plain.substr(kPrefix.size()) : plain;
}

// The names the field's drivers and tools give, the usual one first.
const std::array<std::vector<std::string_view>, kFieldRoles> kNames = {{
    {"x"},
    {"y"},
    {"z"},
    {"intensity", "i", "reflectivity", "reflectance", "intensities"},
    {"ring", "channel", "line", "laser_id", "beam"},
    {"time", "t", "timestamp", "time_stamp", "offset_time", "time_offset", "timeoffset",
     "timestamps", "time_ns", "t_ns", "timestamp_ns", "time_offset_ns"},
    {"nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds", "time_nsec", "t_nsec", "stamp_nsec",
     "timestamp_nsec", "timestamp_nanosec", "time_ns", "t_ns", "timestamp_ns"},
    {"curvature"},
    {"doppler", "velocity", "v_doppler_mps", "doppler_velocity", "range_rate", "radial_speed"},
    {"red", "r", "diffuse_red"},
    {"green", "g", "diffuse_green"},
    {"blue", "b", "diffuse_blue"},
    {"rgb", "rgba"},
}};
const std::vector<std::string_view> kSeconds = {"sec",   "secs",       "seconds",       "time_sec",
                                                "t_sec", "stamp_sec",  "timestamp_sec", "time_s",
                                                "t_s",   "timestamp_s"};

/// The first of the names that is there; -1 where none is.
int index_of(const std::vector<std::string>& names,
             const std::vector<std::string_view>& candidates) {
  for (const std::string_view candidate : candidates) {
    const auto found = std::find(names.begin(), names.end(), candidate);
    if (found != names.end()) {
      return static_cast<int>(found - names.begin());
    }
  }
  return -1;
}

bool is_integer(ScalarType type) {
  return type != ScalarType::f32 && type != ScalarType::f64;
}

/// Throws InputError for integers as coordinates without a scale.
void require_scale(const std::filesystem::path& file, const CloudColumns& columns) {
  for (const FieldRole axis : {FieldRole::x, FieldRole::y, FieldRole::z}) {
    const std::optional<Column>& column = columns[axis];
    if (!column || columns.reading.coordinate_scale) {
      continue;
    }
    if (const ScalarType type = column->written.value_or(column->type); is_integer(type)) {
      throw InputError(file, Place::named("fields x, y, z"),
                       "coordinates are integers of " + std::to_string(8 * size_of(type)) +
                           " bits, and nothing tells how far a step is",
                       "Set recording.coordinate_scale to the metres of a step, such as 0.001 "
                       "where they are millimetres");
    }
  }
}

/// Seconds and nanoseconds, as nanoseconds.
DecodedTimes decode_split_times(const std::filesystem::path& file, const CloudColumns& columns,
                                const std::vector<uint8_t>& valid) {
  constexpr double kMost = 9e9;  // s, 285 years
  std::vector<int64_t> times(valid.size());
  std::vector<uint8_t> impossible(valid.size());
  const auto add = [&](FieldRole role, double unit_ns) {
    for_each_value(*columns[role], valid.size(), [&](std::size_t i, auto value) {
      const auto number = static_cast<double>(value);
      if (!(std::abs(number) * unit_ns < kMost * 1e9)) {
        impossible[i] = 1;
        return;
      }
      times[i] += static_cast<int64_t>(number) * static_cast<int64_t>(unit_ns) +
                  std::llround((number - std::trunc(number)) * unit_ns);
    });
  };
  add(FieldRole::time, 1e9);
  add(FieldRole::nanoseconds, 1.0);
  for (std::size_t i = 0; i < times.size(); ++i) {
    times[i] = impossible[i] != 0 ? std::numeric_limits<int64_t>::max() : times[i];
  }
  CloudReading reading = columns.reading;
  reading.time_unit = 1e-9;
  return understood(file, times, valid, false, reading);
}

/// True where the values are milliseconds: a surface's curvature is 1/3 at most.
bool is_time(const Column& curvature, std::size_t points) {
  bool beyond = false;
  bool possible = true;
  for_each_value(curvature, points, [&](std::size_t, auto value) {
    const auto number = static_cast<double>(value);
    beyond = beyond || number > 1.0;
    possible = possible && !(number < 0.0);
  });
  return beyond && possible;
}

/// The coordinates less `offset`, in double precision until then. No-returns stay at zero.
void fill_relative(const CloudColumns& columns, const Eigen::Vector3d& offset,
                   std::vector<Point>& points) {
  const double scale = columns.reading.coordinate_scale.value_or(1.0);
  std::vector<Eigen::Vector3d> places(points.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for_each_value(*columns.columns[axis], points.size(), [&](std::size_t i, auto value) {
      places[i][static_cast<Eigen::Index>(axis)] = scale * static_cast<double>(value);
    });
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector3d p = places[i].isZero(0.0) ? places[i] : Eigen::Vector3d(places[i] - offset);
    if (p.isZero(0.0) && !places[i].isZero(0.0)) {
      constexpr double kNoDistance = 1e-30;  // m: (0, 0, 0) stands for no return
      p.x() = kNoDistance;
    }
    points[i].x = to_float(p.x());
    points[i].y = to_float(p.y());
    points[i].z = to_float(p.z());
  }
}

/// NaN where a point's is no number. Empty where the column has integers.
std::vector<float> decode_doppler(const Column& column, std::size_t points) {
  std::vector<float> doppler;
  if (is_integer(column.written.value_or(column.type))) {
    return doppler;
  }
  doppler.resize(points);
  for_each_value(column, points, [&](std::size_t i, auto value) {
    const float speed = to_float(value);
    doppler[i] = std::isfinite(speed) ? speed : std::numeric_limits<float>::quiet_NaN();
  });
  return doppler;
}

using Colors = std::vector<std::array<uint8_t, 3>>;

/// A channel, of any type: bytes as they are, wider integers by their upper byte, unless all would
/// be 0, and floating point from 0 to 1, or to 255 where one is above 1.
void decode_channel(const Column& column, std::size_t channel, Colors& colors) {
  const ScalarType type = column.written.value_or(column.type);
  double most = 0.0;
  for_each_value(column, colors.size(), [&](std::size_t, auto value) {
    const auto number = static_cast<double>(value);
    most = std::isfinite(number) ? std::max(most, number) : most;
  });
  const double scale = !is_integer(type) ? (most > 1.0 ? 1.0 : 255.0)
                       : most > 255.0    ? 1.0 / 257.0
                                         : 1.0;
  for_each_value(column, colors.size(), [&](std::size_t i, auto value) {
    const double number = scale * static_cast<double>(value);
    colors[i][channel] = std::isfinite(number)
                             ? static_cast<uint8_t>(std::lround(std::clamp(number, 0.0, 255.0)))
                             : uint8_t{0};
  });
}

/// PCL's: 0x00RRGGBB as an integer, or as the float of these bits. Text has either.
void decode_packed(const Column& column, Colors& colors) {
  const bool text = column.written.has_value();
  for_each_value(column, colors.size(), [&](std::size_t i, auto value) {
    uint32_t packed = 0;
    if constexpr (std::is_floating_point_v<decltype(value)>) {
      constexpr double kMost = 4294967295.0;
      const auto number = static_cast<double>(value);
      const bool whole = text && number >= 1.0 && number <= kMost;
      packed = whole ? static_cast<uint32_t>(number) : std::bit_cast<uint32_t>(to_float(value));
    } else {
      packed = static_cast<uint32_t>(value);
    }
    colors[i] = {static_cast<uint8_t>(packed >> 16U), static_cast<uint8_t>(packed >> 8U),
                 static_cast<uint8_t>(packed)};
  });
}

/// Empty where there are none, or all are black, as those of many files that have a place for them.
Colors decode_colors(const CloudColumns& columns) {
  Colors colors(columns.points);
  if (columns[FieldRole::red] && columns[FieldRole::green] && columns[FieldRole::blue]) {
    decode_channel(*columns[FieldRole::red], 0, colors);
    decode_channel(*columns[FieldRole::green], 1, colors);
    decode_channel(*columns[FieldRole::blue], 2, colors);
  } else if (columns[FieldRole::rgb]) {
    decode_packed(*columns[FieldRole::rgb], colors);
  }
  const bool black =
      std::ranges::all_of(colors, [](const auto& one) { return one == std::array<uint8_t, 3>{}; });
  return black ? Colors() : colors;
}

CloudFile with_optional_fields(const std::filesystem::path& file, const CloudColumns& columns,
                               CloudFile cloud) {
  const std::vector<Point>& points = cloud.sweep.points;
  if (columns.reading.colors) {
    cloud.colors = decode_colors(columns);
  }
  if (columns[FieldRole::doppler]) {
    cloud.sweep.doppler = decode_doppler(*columns[FieldRole::doppler], points.size());
  }
  if (columns[FieldRole::ring]) {
    cloud.sweep.rings.resize(points.size());
    leave_out(file, decode_rings(file, *columns[FieldRole::ring], cloud.sweep.rings), cloud);
  }
  const std::optional<Column>& curvature = columns[FieldRole::curvature];
  const bool by_curvature =
      !columns[FieldRole::time] && curvature && is_time(*curvature, points.size());
  if ((columns[FieldRole::time] || by_curvature) && !points.empty()) {
    std::vector<uint8_t> valid(points.size());
    std::transform(points.begin(), points.end(), valid.begin(),
                   [](const Point& p) { return is_return(p) ? 1 : 0; });
    constexpr double kMilliseconds = 1e-3;  // PCL's users agree on it
    CloudReading reading = columns.reading;
    if (by_curvature) {
      reading.time_unit = reading.time_unit.value_or(kMilliseconds);
    }
    DecodedTimes decoded = by_curvature ? decode_times(file, *curvature, reading, valid)
                           : columns[FieldRole::nanoseconds]
                               ? decode_split_times(file, columns, valid)
                               : decode_times(file, *columns[FieldRole::time], reading, valid);
    leave_out(file, decoded.bad, cloud);
    PointTimes& times = decoded.times;
    cloud.times = PointTimeNature{by_curvature ? "curvature" : columns.time_field, times.unit,
                                  times.absolute, times.absolute ? 0.0 : seconds(times.start)};
    cloud.sweep.stamp = times.start;
    cloud.absolute_stamp = times.absolute;
    cloud.sweep.times = std::move(times.offsets);
  }
  return cloud;
}

}  // namespace

std::size_t size_of(ScalarType type) {
  switch (type) {
    case ScalarType::i8:
    case ScalarType::u8:
      return 1;
    case ScalarType::i16:
    case ScalarType::u16:
      return 2;
    case ScalarType::i32:
    case ScalarType::u32:
    case ScalarType::f32:
      return 4;
    case ScalarType::i64:
    case ScalarType::u64:
    case ScalarType::f64:
      return 8;
  }
  return 0;
}

FieldRoles find_roles(const std::vector<std::string_view>& names, bool colors) {
  std::vector<std::string> plain(names.size());
  std::transform(names.begin(), names.end(), plain.begin(), plain_name);
  FieldRoles roles;
  const std::size_t wanted = colors ? kFieldRoles : static_cast<std::size_t>(FieldRole::red);
  for (std::size_t role = 0; role < wanted; ++role) {
    roles.index[role] = index_of(plain, kNames[role]);
  }
  int& time = roles.index[static_cast<std::size_t>(FieldRole::time)];
  int& rest = roles.index[static_cast<std::size_t>(FieldRole::nanoseconds)];
  const int seconds = index_of(plain, kSeconds);
  if (rest >= 0 && seconds >= 0 && (time < 0 || time == rest)) {
    time = seconds;
  } else {
    rest = -1;
  }
  return roles;
}

InputError with_count(const InputError& first, std::size_t count, std::string_view things) {
  return {first.file(), Place::named(first.place()),
          first.found() + (count > 1 ? fmt::format("; {} {} in all cannot be read", count, things)
                                     : std::string()),
          "The others are read. " + first.remedy()};
}

CloudFile decode_cloud(const std::filesystem::path& file, const CloudColumns& columns) {
  require_scale(file, columns);
  CloudFile cloud;
  const CloudOrigin origin = find_origin(file, columns);
  cloud.sweep.offset = origin.offset;
  cloud.coordinate_step = origin.step;
  cloud.sweep.source = file.string();
  cloud.has_intensity = columns[FieldRole::intensity].has_value();
  std::vector<Point>& points = cloud.sweep.points;
  points.resize(columns.points);
  const auto fill = [&](FieldRole role, float Point::*member) {
    if (columns[role]) {
      for_each_value(*columns[role], points.size(),
                     [&](std::size_t i, auto value) { points[i].*member = to_float(value); });
    }
  };
  fill(FieldRole::intensity, &Point::intensity);
  if (!origin.offset.isZero(0.0)) {
    fill_relative(columns, origin.offset, points);
    return with_optional_fields(file, columns, std::move(cloud));
  }
  fill(FieldRole::x, &Point::x);
  fill(FieldRole::y, &Point::y);
  fill(FieldRole::z, &Point::z);
  if (columns.reading.coordinate_scale) {
    const double scale = *columns.reading.coordinate_scale;
    for (Point& p : points) {
      p.x = static_cast<float>(scale * static_cast<double>(p.x));
      p.y = static_cast<float>(scale * static_cast<double>(p.y));
      p.z = static_cast<float>(scale * static_cast<double>(p.z));
    }
  }
  return with_optional_fields(file, columns, std::move(cloud));
}

}  // namespace adit
