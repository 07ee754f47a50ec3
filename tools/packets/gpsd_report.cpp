// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/gpsd_report.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace adit {
namespace {

using nlohmann::json;

// gpsd's ep* bound 95 % of the errors.
constexpr double k95 = 1.96;

/// Finite, or nothing.
std::optional<double> number_in(const json& report, const char* key) {
  const auto found = report.find(key);
  if (found == report.end() || !found->is_number()) {
    return std::nullopt;
  }
  const auto value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string text_in(const json& report, const char* key) {
  const auto found = report.find(key);
  return found != report.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace

bool is_gpsd_report(std::string_view line) {
  return line.starts_with("{\"class\":\"TPV\"") || line.starts_with("{\"class\":\"GST\"");
}

std::string_view gpsd_line(const Datagram& datagram) {
  const std::string_view text(reinterpret_cast<const char*>(datagram.payload.data()),
                              datagram.payload.size());
  const bool known = is_gpsd_report(text) || text == kGpsdRequest;
  return datagram.port == kGpsdPort && known ? text : std::string_view();
}

std::optional<Nanoseconds> parse_utc(const std::string& text) {
  int year = 0;
  unsigned month = 0;
  unsigned day = 0;
  int hour = 0;
  int minute = 0;
  double second = 0.0;
  if (std::sscanf(text.c_str(), "%4d-%2u-%2uT%2d:%2d:%lfZ", &year, &month, &day, &hour, &minute,
                  &second) != 6) {
    return std::nullopt;
  }
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                         std::chrono::day(day)};
  if (!date.ok() || hour < 0 || hour > 23 || minute < 0 || minute > 59 ||
      !(second >= 0.0 && second < 61.0)) {
    return std::nullopt;
  }
  return std::chrono::sys_days(date).time_since_epoch() + std::chrono::hours(hour) +
         std::chrono::minutes(minute) + nanoseconds(second);
}

std::optional<GnssFix> GpsdReports::take(std::string_view line, Nanoseconds received) {
  const json report = json::parse(line, nullptr, false);
  if (!report.is_object()) {
    return std::nullopt;
  }
  const std::string kind = text_in(report, "class");
  if (kind == "GST") {
    const auto north = number_in(report, "lat");
    const auto east = number_in(report, "lon");
    const auto up = number_in(report, "alt");
    deviations_.reset();
    if (north && east && up) {
      deviations_ = {.time = text_in(report, "time"), .east = *east, .north = *north, .up = *up};
    }
    return std::nullopt;
  }
  const auto mode = number_in(report, "mode");
  const auto latitude = number_in(report, "lat");
  const auto longitude = number_in(report, "lon");
  const auto altitude = number_in(report, "altHAE");
  if (kind != "TPV" || !mode || *mode < 3.0 || !latitude || !longitude || !altitude) {
    return std::nullopt;
  }
  const std::string time = text_in(report, "time");
  // gpsd: 2 is a differential fix, 3 and 4 a real-time kinematic one.
  const bool augmented = number_in(report, "status").value_or(1.0) >= 2.0;
  GnssFix fix{.stamp = parse_utc(time).value_or(received),
              .kind = augmented ? GnssFixKind::ground_augmented : GnssFixKind::single,
              .latitude = *latitude,
              .longitude = *longitude,
              .altitude = *altitude,
              .covariance = std::nullopt};
  std::optional<Deviations> sigma;
  if (deviations_ && deviations_->time == time) {
    sigma = deviations_;
  } else if (const auto east = number_in(report, "epx"), north = number_in(report, "epy"),
             up = number_in(report, "epv");
             east && north && up) {
    sigma = {.time = time, .east = *east / k95, .north = *north / k95, .up = *up / k95};
  }
  if (sigma) {
    const Eigen::Vector3d deviations(sigma->east, sigma->north, sigma->up);
    fix.covariance = deviations.cwiseAbs2().asDiagonal().toDenseMatrix();
  }
  return fix;
}

}  // namespace adit
