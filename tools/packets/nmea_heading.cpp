// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/nmea_heading.hpp"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

/// From behind '$' to before '*', where the checksum behind that is right; else empty.
std::string_view checked_body(std::string_view sentence) {
  const std::size_t begin = sentence.find('$');
  if (begin == std::string_view::npos) {
    return {};
  }
  sentence.remove_prefix(begin + 1);
  const std::size_t end = sentence.find('*');
  if (end == std::string_view::npos || sentence.size() < end + 3) {
    return {};
  }
  unsigned stated = 0;
  const char* const digits = sentence.data() + end + 1;
  const auto [last, error] = std::from_chars(digits, digits + 2, stated, 16);
  unsigned sum = 0;
  for (const char one : sentence.substr(0, end)) {
    sum ^= static_cast<unsigned char>(one);
  }
  return error == std::errc() && last == digits + 2 && stated == sum ? sentence.substr(0, end)
                                                                     : std::string_view();
}

std::vector<std::string_view> nmea_fields(std::string_view body) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = body.find(',');
    fields.push_back(body.substr(0, comma));
    if (comma == std::string_view::npos) {
      return fields;
    }
    body.remove_prefix(comma + 1);
  }
}

/// Finite and within the bounds, or nothing.
std::optional<double> nmea_number(std::string_view field, double least, double most) {
  double value = 0.0;
  const auto [last, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  const bool whole = error == std::errc() && last == field.data() + field.size();
  return whole && value >= least && value <= most ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<NmeaHeading> nmea_heading(std::string_view sentence) {
  const std::vector<std::string_view> fields = nmea_fields(checked_body(sentence));
  const std::string_view name = fields.front();
  // PASHR: time, heading, T, roll, pitch, heave, deviations of roll, pitch and heading, quality.
  const bool attitude = name == "PASHR" && fields.size() >= 11 && fields[3] == "T";
  const bool heading =
      name.size() == 5 && name.ends_with("HDT") && fields.size() >= 3 && fields[2] == "T";
  const bool heading_with_mode =
      name.size() == 5 && name.ends_with("THS") && fields.size() >= 3 && fields[2] == "A";
  if (!attitude && !heading && !heading_with_mode) {
    return std::nullopt;
  }
  const std::optional<double> bearing = nmea_number(fields[attitude ? 2 : 1], 0.0, 360.0);
  if (!bearing || (attitude && fields[10] == "0")) {
    return std::nullopt;
  }
  NmeaHeading found{.yaw = yaw_of_bearing(*bearing * kDegree)};
  const auto deviation = attitude ? nmea_number(fields[9], 1e-6, 180.0) : std::nullopt;
  if (deviation) {
    found.sigma = *deviation * kDegree;
  }
  return found;
}

}  // namespace adit
