// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "adit/slam/core/types.hpp"
#include "adit/tools/packets/datagram_assembly.hpp"

namespace adit {

/// Where gpsd answers, and of what its reports among packets are.
inline constexpr uint16_t kGpsdPort = 2947;
/// What it is asked with, a line.
inline constexpr std::string_view kGpsdRequest = "?WATCH={\"enable\":true,\"json\":true};\n";

/// Whether a line is a report on position: TPV or GST.
bool is_gpsd_report(std::string_view line);

/// What a gpsd was asked or reports in a datagram of a recording of packets; else empty.
std::string_view gpsd_line(const Datagram& datagram);

/// Reads what gpsd reports, a line of JSON each (gpsd_json(5)): TPV has the position, GST the
/// standard deviations of the same receiver.
class GpsdReports {
 public:
  /// The fix that the line completes, with covariances (east, north, up, m²) where gpsd reports
  /// them; nothing for other lines and for what is no report. `received` is its time where the
  /// report has none.
  std::optional<GnssFix> take(std::string_view line, Nanoseconds received);

 private:
  /// Standard deviations, m.
  struct Deviations {
    std::string time;  ///< of the report; those of another time are not used
    double east = 0.0;
    double north = 0.0;
    double up = 0.0;
  };

  std::optional<Deviations> deviations_{};
};

/// "2026-11-29T10:20:30.500Z" since 1970; nothing where it is no such time.
std::optional<Nanoseconds> parse_utc(const std::string& text);

}  // namespace adit
