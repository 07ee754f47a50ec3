// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace adit {

/// What an NMEA 0183 sentence says of where something points.
struct NmeaHeading {
  double yaw = 0.0;               ///< rad, counter-clockwise from true east
  std::optional<double> sigma{};  ///< rad; none: the sentence has none
};

/// The heading against true north of a sentence that has one: HDT, THS (only where it is measured:
/// mode A) and PASHR, of any talker. Nothing for other sentences, for those without a heading, and
/// where the checksum is missing or wrong.
std::optional<NmeaHeading> nmea_heading(std::string_view sentence);

}  // namespace adit
