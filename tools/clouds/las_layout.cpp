// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Numbers are written as they lie in memory.
#include "adit/tools/clouds/las_layout.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include <fmt/core.h>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/raw_bytes.hpp"

namespace adit {
namespace {

constexpr uint16_t kAdjustedTime = 1U << 0U;
constexpr uint16_t kWkt = 1U << 4U;
constexpr uint8_t kFormat = 6;
constexpr uint8_t kColoredFormat = 7;
constexpr uint8_t kPackedFormat = 0x80;
constexpr int64_t kSecond = 1'000'000'000;
constexpr int64_t kGpsEpoch = 315'964'800;  // 1980-01-06 in UNIX time, s

/// UNIX times at which a leap second had just been inserted, since GPS time began (IERS).
constexpr std::array<int64_t, 18> kLeapSeconds = {
    362793600, 394329600,  425865600,  489024000,  567993600,  631152000,
    662688000, 709948800,  741484800,  773020800,  820454400,  867715200,
    915148800, 1136073600, 1230768000, 1341100800, 1435708800, 1483228800};

/// A dimension of the Extra Bytes record; type 3 is uint16, 5 uint32.
std::string extra_bytes(uint8_t type, std::string_view name, std::string_view description) {
  std::string bytes(2, '\0');
  append_raw(bytes, type);
  append_raw(bytes, uint8_t{0});
  append_padded(bytes, name, 32);
  bytes.append(4 + 5 * 24, '\0');  // no "no data" value, no range, no scale
  append_padded(bytes, description, 32);
  return bytes;
}

std::string class_names() {
  std::string bytes(256 * 16, '\0');
  const auto name = [&](LasClass number, std::string_view text) {
    const auto at = static_cast<std::size_t>(number);
    std::string entry;
    append_raw(entry, static_cast<uint8_t>(number));
    append_padded(entry, text, 15);
    bytes.replace(16 * at, 16, entry);
  };
  for (std::size_t i = 0; i < 256; ++i) {
    bytes[16 * i] = static_cast<char>(static_cast<uint8_t>(i));
  }
  name(LasClass::unclassified, "unclassified");
  name(LasClass::moving, "moving");
  name(LasClass::mixed, "mixed");
  name(LasClass::carrier, "carrier");
  return bytes;
}

/// A point of format 6 as it lies in a file.
#pragma pack(push, 1)
struct PackedPoint {
  std::array<int32_t, 3> position;  ///< steps
  uint16_t intensity;
  uint8_t returns = 0x11;  ///< the first return of one
  uint8_t flags = 0;
  uint8_t classification;
  uint8_t user = 0;
  int16_t angle = 0;  ///< not known
  uint16_t source;
  double time;
};
struct ExtraBytes {
  uint16_t ring;
  uint32_t keyframe;
};
#pragma pack(pop)
static_assert(sizeof(PackedPoint) == kLas6Bytes);

/// From 8 to 16 bits, so that 255 becomes 65535 (LAS 1.4 R15: "Red, Green, Blue").
std::array<uint16_t, 3> wide_color(const std::array<uint8_t, 3>& color) {
  std::array<uint16_t, 3> wide{};
  std::ranges::transform(color, wide.begin(),
                         [](uint8_t value) { return static_cast<uint16_t>(257U * value); });
  static_assert(sizeof(wide) == kLasColorBytes);
  return wide;
}

}  // namespace

LasPointLayout las_point_layout(const LasHeading& heading) {
  return {.colored = heading.colored, .extra_bytes = sizeof(ExtraBytes)};
}

bool is_unix_time(Nanoseconds stamp) {
  return stamp.count() >= 946'684'800 * kSecond && stamp.count() < 4'102'444'800 * kSecond;
}

double adjusted_gps_time(Nanoseconds unix_time) {
  const int64_t second = unix_time.count() / kSecond;
  const auto leap = std::ranges::upper_bound(kLeapSeconds, second) - kLeapSeconds.begin();
  const int64_t whole = second - kGpsEpoch + leap - 1'000'000'000;
  return static_cast<double>(whole) + static_cast<double>(unix_time.count() % kSecond) * 1e-9;
}

void append_padded(std::string& bytes, std::string_view text, std::size_t size) {
  bytes.append(text.substr(0, size));
  bytes.append(size - std::min(size, text.size()), '\0');
}

void LasRecords::add(std::string_view user, uint16_t id, std::string_view description,
                     std::string_view content) {
  append_raw(bytes, uint16_t{0});
  append_padded(bytes, user, 16);
  append_raw(bytes, id);
  append_raw(bytes, static_cast<uint16_t>(content.size()));
  append_padded(bytes, description, 32);
  bytes.append(content);
  ++count;
}

void add_las_records(LasRecords& records, const LasHeading& heading) {
  if (!heading.wkt.empty()) {
    records.add("LASF_Projection", 2112, "OGC WKT", heading.wkt + std::string(1, '\0'));
  }
  records.add("LASF_Spec", 4, "Extra Bytes",
              extra_bytes(3, "ring", "beam of the sensor") +
                  extra_bytes(5, "keyframe", "node of the pose graph"));
  records.add("LASF_Spec", 0, "Classification", class_names());
}

void append_las_point(std::string& bytes, LasExtent& extent, const LasPoint& point,
                      const LasHeading& heading, const std::filesystem::path& file) {
  std::array<int32_t, 3> steps{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double rounded = std::round((point.position[i] - heading.offset[i]) / kLasScale);
    if (!(std::abs(rounded) < 2e9)) {
      throw OutputError(
          file,
          fmt::format("{}: a point at {:.3f}, {:.3f}, {:.3f} m is beyond the 2000 km about "
                      "{:.0f}, {:.0f}, {:.0f} that a LAS file in millimetres can hold. Leave "
                      "it out with --box.",
                      file.string(), point.position.x(), point.position.y(), point.position.z(),
                      heading.offset.x(), heading.offset.y(), heading.offset.z()));
    }
    const auto step = static_cast<int32_t>(rounded);
    extent.lowest[axis] = extent.points == 0 ? step : std::min(extent.lowest[axis], step);
    extent.highest[axis] = extent.points == 0 ? step : std::max(extent.highest[axis], step);
    steps[axis] = step;
  }
  if (!extent.first) {
    extent.first = point.time;
  }
  const double time = heading.unix_times ? adjusted_gps_time(point.time) : seconds(point.time);
  extent.earliest = std::min(extent.earliest, time);
  extent.latest = std::max(extent.latest, time);
  const PackedPoint packed{.position = steps,
                           .intensity = point.intensity,
                           .classification = static_cast<uint8_t>(point.classification),
                           .source = point.source,
                           .time = time};
  append_raw(bytes, packed);
  if (heading.colored) {
    append_raw(bytes, wide_color(point.color));
  }
  append_raw(bytes, ExtraBytes{.ring = point.ring, .keyframe = point.keyframe});
  ++extent.points;
}

std::string las_header(const LasHeading& heading, const LasExtent& extent,
                       const LasFraming& framing) {
  std::string bytes = "LASF";
  append_raw(bytes, uint16_t{0});  // file source ID
  append_raw(bytes, static_cast<uint16_t>((heading.unix_times ? kAdjustedTime : 0U) | kWkt));
  bytes.append(16, '\0');  // GUID
  append_raw(bytes, uint8_t{1});
  append_raw(bytes, uint8_t{4});
  append_padded(bytes, "adit", 32);
  append_padded(bytes, heading.software, 32);
  uint16_t day = 0;
  uint16_t year = 0;
  if (heading.unix_times && extent.first) {
    const auto date =
        std::chrono::floor<std::chrono::days>(std::chrono::sys_time<Nanoseconds>(*extent.first));
    const std::chrono::year_month_day parts(date);
    const std::chrono::sys_days new_year = parts.year() / std::chrono::January / 1;
    day = static_cast<uint16_t>((date - new_year).count() + 1);
    year = static_cast<uint16_t>(static_cast<int>(parts.year()));
  }
  append_raw(bytes, day);
  append_raw(bytes, year);
  append_raw(bytes, kLasHeaderBytes);
  append_raw(bytes, static_cast<uint32_t>(kLasHeaderBytes + framing.record_bytes));
  append_raw(bytes, framing.records);
  append_raw(bytes, static_cast<uint8_t>((heading.colored ? kColoredFormat : kFormat) |
                                         (framing.packed ? kPackedFormat : 0U)));
  append_raw(bytes, static_cast<uint16_t>(las_point_layout(heading).bytes()));
  bytes.append(6 * 4, '\0');  // counts of earlier versions
  for (int axis = 0; axis < 3; ++axis) {
    append_raw(bytes, kLasScale);
  }
  for (int axis = 0; axis < 3; ++axis) {
    append_raw(bytes, heading.offset[axis]);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double offset =
        extent.points == 0 ? 0.0 : heading.offset[static_cast<Eigen::Index>(axis)];
    append_raw(bytes, kLasScale * extent.highest[axis] + offset);
    append_raw(bytes, kLasScale * extent.lowest[axis] + offset);
  }
  append_raw(bytes, uint64_t{0});  // no waveforms
  append_raw(bytes, framing.extended_begin);
  append_raw(bytes, framing.extended);
  append_raw(bytes, extent.points);
  append_raw(bytes, extent.points);  // of first returns
  bytes.append(14 * 8, '\0');
  return bytes;
}

}  // namespace adit
