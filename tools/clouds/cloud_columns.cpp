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

bool is_return(const Point& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) &&
         (p.x != 0.0F || p.y != 0.0F || p.z != 0.0F);
}

/// Times as integers or doubles, whichever the column holds; 64-bit integers do not pass through a
/// double.
PointTimes decode_times(const std::filesystem::path& file, const Column& column, double unit,
                        const std::vector<Point>& points) {
  std::vector<uint8_t> valid(points.size());
  std::transform(points.begin(), points.end(), valid.begin(),
                 [](const Point& p) { return is_return(p) ? 1 : 0; });
  const bool floating = column.type == ScalarType::f32 || column.type == ScalarType::f64;
  if (floating) {
    std::vector<double> times(points.size());
    for_each_value(column, points.size(),
                   [&](std::size_t i, auto value) { times[i] = static_cast<double>(value); });
    return interpret_times(file, times, valid, column.type == ScalarType::f32, unit);
  }
  std::vector<int64_t> times(points.size());
  for_each_value(column, points.size(), [&](std::size_t i, auto value) {
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
    {"intensity", "reflectivity", "reflectance", "intensities"},
    {"ring", "channel", "line", "laser_id", "beam"},
    {"time", "t", "timestamp", "time_stamp", "offset_time", "time_offset", "timeoffset",
     "timestamps"},
}};

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
    for (const std::string_view candidate : kNames[role]) {
      const auto found = std::find(plain.begin(), plain.end(), candidate);
      if (found != plain.end()) {
        roles.index[role] = static_cast<int>(found - plain.begin());
        break;
      }
    }
  }
  return roles;
}

CloudFile decode_cloud(const std::filesystem::path& file, const CloudColumns& columns) {
  CloudFile cloud;
  cloud.sweep.source = file.string();
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
  if (columns[FieldRole::ring]) {
    cloud.sweep.rings = decode_rings(file, *columns[FieldRole::ring], points.size());
  }
  if (columns[FieldRole::time] && !points.empty()) {
    PointTimes times = decode_times(file, *columns[FieldRole::time], columns.time_unit, points);
    cloud.times =
        PointTimeNature{columns.time_field, times.unit, times.absolute,
                        times.absolute ? 0.0 : std::chrono::duration<double>(times.start).count()};
    cloud.sweep.stamp = times.start;
    cloud.absolute_stamp = times.absolute;
    cloud.sweep.times = std::move(times.offsets);
  }
  return cloud;
}

}  // namespace adit
