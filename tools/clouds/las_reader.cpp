// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/las_reader.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr std::size_t kSmallestHeader = 227;  // bytes, of version 1.0
constexpr const char* kRemedy = "The file is damaged or cut off: write it again";

/// Where the GPS time lies in a point of each format; 0: it has none.
constexpr std::array<std::size_t, 11> kTimeOffsets = {0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22};
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
  uint64_t begin = 0;  ///< byte of the first point
  std::size_t point_bytes = 0;
  std::size_t format = 0;
  std::array<double, 3> scale{};
  std::array<double, 3> offset{};
  std::optional<InputError> fault{};  ///< of the number of points
};

LasHeader parse_header(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  if (bytes.size() < kSmallestHeader || std::memcmp(bytes.data(), "LASF", 4) != 0) {
    throw InputError(file, Place::byte(0), "it does not begin like a LAS file", kRemedy);
  }
  LasHeader header;
  const auto minor = load<uint8_t>(bytes, 25);
  const auto format = load<uint8_t>(bytes, 104);
  if ((format & 0x80U) != 0) {
    throw InputError(file, Place::byte(104), "its points are packed (LAZ)",
                     "Unpack it, for example with laszip or PDAL");
  }
  if (format >= kTimeOffsets.size()) {
    throw InputError(file, Place::byte(104),
                     "its point format is " + std::to_string(format) + "; 0 to 10 are known",
                     kRemedy);
  }
  header.format = format;
  header.begin = load<uint32_t>(bytes, 96);
  header.point_bytes = load<uint16_t>(bytes, 105);
  header.points = load<uint32_t>(bytes, 107);
  constexpr std::size_t kHeader14 = 375;
  if (minor >= 4 && bytes.size() >= kHeader14) {
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
  const uint64_t left = header.begin > bytes.size() ? 0 : bytes.size() - header.begin;
  const uint64_t there = left / header.point_bytes;
  // Later versions may have other records behind the points.
  const bool points_last = minor < 3 && header.begin < bytes.size();
  const bool more = points_last && there > header.points && left % header.point_bytes == 0;
  if (header.points > there || more) {
    InputError fault(file, Place::byte(header.begin),
                     "the header promises " + std::to_string(header.points) + " points of " +
                         std::to_string(header.point_bytes) + " bytes; the file holds " +
                         std::to_string(there) + (there > 0 ? ", which are read" : ""),
                     kRemedy);
    if (there == 0) {
      throw fault;
    }
    header.fault = fault;
    header.points = there;
  }
  return header;
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
  const auto points = static_cast<std::size_t>(header.points);
  std::vector<double> coordinates(3 * points);
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t at = static_cast<std::size_t>(header.begin) + i * header.point_bytes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      coordinates[3 * i + axis] =
          header.scale[axis] * load<int32_t>(bytes, at + 4 * axis) + header.offset[axis];
    }
  }
  CloudColumns columns;
  columns.points = points;
  columns.time_field = "GPS time";
  columns.reading = reading;
  columns.reading.coordinate_scale.reset();                     // its header tells it
  columns.reading.time_unit = reading.time_unit.value_or(1.0);  // GPS time is in seconds
  const auto* first = reinterpret_cast<const std::byte*>(coordinates.data());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns.columns[axis] =
        Column{first, axis * sizeof(double), 3 * sizeof(double), ScalarType::f64, false};
  }
  const std::byte* records = points == 0 ? bytes.data() : bytes.data() + header.begin;
  columns[FieldRole::intensity] = Column{records, 12, header.point_bytes, ScalarType::u16, false};
  if (const std::size_t time = kTimeOffsets[header.format]; time > 0) {
    columns[FieldRole::time] = Column{records, time, header.point_bytes, ScalarType::f64, false};
  }
  CloudFile cloud = decoded(file, columns);
  if (header.fault) {
    cloud.faults.push_back(*header.fault);
  }
  return cloud;
}

CloudFile read_las(const std::filesystem::path& file, const CloudReading& reading) {
  return parse_las(file, read_whole_file(file), reading);
}

}  // namespace adit
