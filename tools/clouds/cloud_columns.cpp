// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/cloud_columns.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

#include "adit/tools/clouds/returns.hpp"

namespace adit {
namespace {

template <class T>
T load(const std::byte* from, bool swap_bytes) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (swap_bytes) {
    std::reverse(bytes.begin(), bytes.end());
  }
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

/// Calls take(i, value) for each number of the column, in the column's own type.
template <class Take>
void for_each_value(const Column& column, std::size_t count, Take&& take) {
  const auto run = [&]<class T>(T) {
    for (std::size_t i = 0; i < count; ++i) {
      take(i, load<T>(column.data + column.offset + i * column.stride, column.swap_bytes));
    }
  };
  switch (column.type) {
    case ScalarType::i8:
      return run(int8_t{});
    case ScalarType::u8:
      return run(uint8_t{});
    case ScalarType::i16:
      return run(int16_t{});
    case ScalarType::u16:
      return run(uint16_t{});
    case ScalarType::i32:
      return run(int32_t{});
    case ScalarType::u32:
      return run(uint32_t{});
    case ScalarType::i64:
      return run(int64_t{});
    case ScalarType::u64:
      return run(uint64_t{});
    case ScalarType::f32:
      return run(float{});
    case ScalarType::f64:
      return run(double{});
  }
}

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

std::vector<uint16_t> decode_rings(const std::filesystem::path& file, const Column& column,
                                   std::size_t points) {
  std::vector<uint16_t> rings(points);
  for_each_value(column, points, [&](std::size_t i, auto value) {
    const auto number = static_cast<double>(value);
    if (!(number >= 0.0 && number <= 65535.0)) {
      throw InputError(
          file, Place::point(i),
          "its ring is " + std::to_string(number) + ", not a beam number of 0 to 65535",
          "The file is damaged, or the field means something else: rename it");
    }
    rings[i] = static_cast<uint16_t>(number);
  });
  return rings;
}

/// Times as integers or doubles, whichever the column holds; 64-bit integers do not pass through a
/// double.
PointTimes decode_times(const std::filesystem::path& file, const Column& column,
                        std::optional<double> unit, const std::vector<uint8_t>& valid) {
  const bool floating = column.type == ScalarType::f32 || column.type == ScalarType::f64;
  if (floating) {
    std::vector<double> times(valid.size());
    for_each_value(column, valid.size(),
                   [&](std::size_t i, auto value) { times[i] = static_cast<double>(value); });
    return interpret_times(file, times, valid, column.type == ScalarType::f32, unit);
  }
  std::vector<int64_t> times(valid.size());
  for_each_value(column, valid.size(), [&](std::size_t i, auto value) {
    if constexpr (std::is_same_v<decltype(value), uint64_t>) {
      if (value > static_cast<uint64_t>(std::numeric_limits<int64_t>::max())) {
        throw InputError(file, Place::point(i),
                         "its time is " + std::to_string(value) + ", which no clock shows",
                         "The file is damaged: write it again");
      }
    }
    if constexpr (std::is_integral_v<decltype(value)>) {
      times[i] = static_cast<int64_t>(value);
    }
  });
  return interpret_times(file, times, valid, unit);
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
PointTimes decode_split_times(const std::filesystem::path& file, const CloudColumns& columns,
                              const std::vector<uint8_t>& valid) {
  constexpr double kMost = 9e9;  // s, 285 years
  std::vector<int64_t> times(valid.size());
  const auto add = [&](FieldRole role, double unit_ns) {
    for_each_value(*columns[role], valid.size(), [&](std::size_t i, auto value) {
      const auto number = static_cast<double>(value);
      if (!(std::abs(number) * unit_ns < kMost * 1e9)) {
        if (valid[i] == 0) {
          return;  // no return, no time
        }
        throw InputError(file, Place::point(i), "its time is no time that a clock shows",
                         "The file is damaged: write it again");
      }
      times[i] += static_cast<int64_t>(number) * static_cast<int64_t>(unit_ns) +
                  std::llround((number - std::trunc(number)) * unit_ns);
    });
  };
  add(FieldRole::time, 1e9);
  add(FieldRole::nanoseconds, 1.0);
  return interpret_times(file, times, valid, 1e-9);
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

FieldRoles find_roles(const std::vector<std::string_view>& names) {
  std::vector<std::string> plain(names.size());
  std::transform(names.begin(), names.end(), plain.begin(), plain_name);
  FieldRoles roles;
  for (std::size_t role = 0; role < kFieldRoles; ++role) {
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

CloudFile decode_cloud(const std::filesystem::path& file, const CloudColumns& columns) {
  require_scale(file, columns);
  CloudFile cloud;
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
  fill(FieldRole::x, &Point::x);
  fill(FieldRole::y, &Point::y);
  fill(FieldRole::z, &Point::z);
  fill(FieldRole::intensity, &Point::intensity);
  if (columns.reading.coordinate_scale) {
    const double scale = *columns.reading.coordinate_scale;
    for (Point& p : points) {
      p.x = static_cast<float>(scale * static_cast<double>(p.x));
      p.y = static_cast<float>(scale * static_cast<double>(p.y));
      p.z = static_cast<float>(scale * static_cast<double>(p.z));
    }
  }
  if (columns[FieldRole::ring]) {
    cloud.sweep.rings = decode_rings(file, *columns[FieldRole::ring], points.size());
  }
  const std::optional<Column>& curvature = columns[FieldRole::curvature];
  const bool by_curvature =
      !columns[FieldRole::time] && curvature && is_time(*curvature, points.size());
  if ((columns[FieldRole::time] || by_curvature) && !points.empty()) {
    std::vector<uint8_t> valid(points.size());
    std::transform(points.begin(), points.end(), valid.begin(),
                   [](const Point& p) { return is_return(p) ? 1 : 0; });
    constexpr double kMilliseconds = 1e-3;  // PCL's users agree on it
    const std::optional<double> unit = columns.reading.time_unit;
    PointTimes times = by_curvature
                           ? decode_times(file, *curvature, unit.value_or(kMilliseconds), valid)
                       : columns[FieldRole::nanoseconds]
                           ? decode_split_times(file, columns, valid)
                           : decode_times(file, *columns[FieldRole::time], unit, valid);
    cloud.times = PointTimeNature{by_curvature ? "curvature" : columns.time_field, times.unit,
                                  times.absolute, times.absolute ? 0.0 : seconds(times.start)};
    cloud.sweep.stamp = times.start;
    cloud.absolute_stamp = times.absolute;
    cloud.sweep.times = std::move(times.offsets);
  }
  return cloud;
}

}  // namespace adit
