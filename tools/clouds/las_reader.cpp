// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/las_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/clouds/laz_reader.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr std::size_t kSmallestHeader = 227;  // bytes, of version 1.0
constexpr const char* kRemedy = "The file is damaged or cut off: write it again";

/// Where the GPS time lies in a point of each format; 0: it has none.
constexpr std::array<std::size_t, 11> kTimeOffsets = {0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22};
/// The same of red, green and blue, 16 bits each.
constexpr std::array<std::size_t, 11> kColorOffsets = {0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
constexpr std::array<std::size_t, 11> kSmallestPoints = {20, 28, 26, 34, 57, 63,
                                                         30, 36, 38, 59, 67};

template <class T>
T load(std::span<const std::byte> from, std::size_t at) {
  T value;
  std::memcpy(&value, from.subspan(at, sizeof(T)).data(), sizeof(T));
  return value;
}

struct LasHeader {
  uint64_t points = 0;
  std::size_t begin = 0;  ///< byte of the first point
  std::size_t point_bytes = 0;
  std::size_t format = 0;
  std::size_t header_bytes = 0;
  uint8_t minor = 0;  ///< version 1.this
  bool packed = false;
  std::array<double, 3> scale{};
  std::array<double, 3> offset{};
};

LasHeader parse_header(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  if (bytes.size() < kSmallestHeader || std::memcmp(bytes.data(), "LASF", 4) != 0) {
    throw InputError(file, Place::byte(0), "it does not begin like a LAS file", kRemedy);
  }
  LasHeader header;
  header.minor = load<uint8_t>(bytes, 25);
  const auto packed_format = load<uint8_t>(bytes, 104);
  const uint8_t format = packed_format & 0x3fU;  // the upper bits say that points are packed
  header.packed = (packed_format & 0x80U) != 0;
  if (format >= kTimeOffsets.size()) {
    throw InputError(file, Place::byte(104),
                     "its point format is " + std::to_string(format) + "; 0 to 10 are known",
                     kRemedy);
  }
  header.format = format;
  header.header_bytes = load<uint16_t>(bytes, 94);
  header.begin = load<uint32_t>(bytes, 96);
  header.point_bytes = load<uint16_t>(bytes, 105);
  header.points = load<uint32_t>(bytes, 107);
  constexpr std::size_t kHeader14 = 375;
  if (header.minor >= 4 && bytes.size() >= kHeader14) {
    const auto points = load<uint64_t>(bytes, 247);
    header.points = points > 0 ? points : header.points;  // some write the old field alone
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.scale[axis] = load<double>(bytes, 131 + 8 * axis);
    header.offset[axis] = load<double>(bytes, 155 + 8 * axis);
    if (!std::isfinite(header.scale[axis]) || !std::isfinite(header.offset[axis])) {
      throw InputError(file, Place::byte(131 + 8 * axis), "its scale or offset is no number",
                       kRemedy);
    }
  }
  if (header.point_bytes < kSmallestPoints[header.format]) {
    throw InputError(file, Place::byte(105),
                     "points of format " + std::to_string(format) + " need " +
                         std::to_string(kSmallestPoints[header.format]) + " bytes, these have " +
                         std::to_string(header.point_bytes),
                     kRemedy);
  }
  return header;
}

/// The bytes of the points, and what is wrong with their number.
struct LasContent {
  std::span<const std::byte> points{};
  std::size_t point_bytes = 1;  ///< from one to the next
  std::string unpacked{};       ///< of a packed file: what `points` is of
  std::string fault{};
};

LasContent plain_points(std::span<const std::byte> bytes, const LasHeader& header) {
  const std::span<const std::byte> points = bytes.subspan(std::min(header.begin, bytes.size()));
  const uint64_t there = points.size() / header.point_bytes;
  // Later versions may have other records behind the points.
  const bool points_last = header.minor < 3 && header.begin < bytes.size();
  const bool more = points_last && there > header.points && points.size() % header.point_bytes == 0;
  if (header.points <= there && !more) {
    return {.points = points.first(header.points * header.point_bytes),
            .point_bytes = header.point_bytes};
  }
  return {.points = points.first(there * header.point_bytes),
          .point_bytes = header.point_bytes,
          .fault = "the header promises " + std::to_string(header.points) + " points of " +
                   std::to_string(header.point_bytes) + " bytes; the file holds " +
                   std::to_string(there) + (there > 0 ? ", which are read" : "")};
}

LasContent unpacked_points(std::span<const std::byte> bytes, const LasHeader& header) {
  const std::size_t begin = std::min(header.begin, bytes.size());
  const std::size_t records = std::min(header.header_bytes, begin);
  LazPoints points = unpack_laz(bytes, {.begin = header.begin,
                                        .points = header.points,
                                        .format = header.format,
                                        .point_bytes = header.point_bytes,
                                        .records = bytes.subspan(records, begin - records)});
  LasContent content{.point_bytes = points.point_bytes,
                     .unpacked = std::move(points.bytes),
                     .fault = std::move(points.fault)};
  content.points = std::as_bytes(std::span(content.unpacked.data(), content.unpacked.size()));
  return content;
}

/// Points of a survey span more time than a sweep lasts: they have places all the same.
CloudFile decoded(const std::filesystem::path& file, CloudColumns& columns) {
  try {
    return decode_cloud(file, columns);
  } catch (const InputError& error) {
    if (!columns[FieldRole::time]) {
      throw;
    }
    columns[FieldRole::time].reset();
    CloudFile cloud = decode_cloud(file, columns);
    cloud.faults.emplace_back(file, Place::named(error.place()),
                              error.found() + "; the times of all points are left out",
                              "Sweeps of a recording need a file each");
    return cloud;
  }
}

}  // namespace

CloudFile parse_las(const std::filesystem::path& file, std::string_view content,
                    const CloudReading& reading) {
  const std::span<const std::byte> bytes = std::as_bytes(std::span(content.data(), content.size()));
  const LasHeader header = parse_header(file, bytes);
  const LasContent held =
      header.packed ? unpacked_points(bytes, header) : plain_points(bytes, header);
  const std::size_t points = held.points.size() / held.point_bytes;
  std::optional<InputError> fault;
  if (!held.fault.empty()) {
    fault.emplace(file, Place::byte(header.begin), held.fault, kRemedy);
    if (points == 0) {
      throw *fault;
    }
  }
  std::vector<double> coordinates(3 * points);
  for (std::size_t i = 0; i < points; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto steps = load<int32_t>(held.points, i * held.point_bytes + 4 * axis);
      coordinates[3 * i + axis] = header.scale[axis] * steps + header.offset[axis];
    }
  }
  CloudColumns columns;
  columns.points = points;
  columns.time_field = "GPS time";
  columns.reading = reading;
  columns.reading.coordinate_scale.reset();                     // its header has it
  columns.reading.time_unit = reading.time_unit.value_or(1.0);  // GPS time is in seconds
  const auto* first = reinterpret_cast<const std::byte*>(coordinates.data());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns.columns[axis] =
        Column{first, axis * sizeof(double), 3 * sizeof(double), ScalarType::f64, false};
  }
  const std::byte* records = points == 0 ? bytes.data() : held.points.data();
  columns[FieldRole::intensity] = Column{records, 12, held.point_bytes, ScalarType::u16, false};
  if (const std::size_t time = kTimeOffsets[header.format]; time > 0) {
    columns[FieldRole::time] = Column{records, time, held.point_bytes, ScalarType::f64, false};
  }
  if (const std::size_t color = kColorOffsets[header.format]; color > 0) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      columns.columns[static_cast<std::size_t>(FieldRole::red) + channel] =
          Column{records, color + 2 * channel, held.point_bytes, ScalarType::u16, false};
    }
  }
  CloudFile cloud = decoded(file, columns);
  if (fault) {
    cloud.faults.push_back(*fault);
  }
  return cloud;
}

CloudFile read_las(const std::filesystem::path& file, const CloudReading& reading) {
  return parse_las(file, read_whole_file(file), reading);
}

}  // namespace adit
