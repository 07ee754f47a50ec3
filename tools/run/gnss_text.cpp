// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/gnss_text.hpp"

#include <cmath>
#include <numbers>

#include <fmt/core.h>

namespace adit {
namespace {

std::size_t count(const GnssReport& gnss, FixVerdict verdict) {
  return gnss.verdicts[static_cast<std::size_t>(verdict)];
}

/// Of the map's x axis, clockwise from north, degrees.
double heading(const Georeference& georeference) {
  const Eigen::Vector3d x = georeference.T_world_map.linear().col(0);
  const double degrees = std::atan2(x.x(), x.y()) * 180.0 / std::numbers::pi;
  return degrees < 0.0 ? degrees + 360.0 : degrees;
}

double yaw_sigma(const Georeference& georeference) {
  return std::sqrt(georeference.covariance(5, 5)) * 180.0 / std::numbers::pi;
}

std::string why_not(const GnssReport& gnss) {
  if (gnss.swapped) {
    return "with latitude and longitude exchanged the fixes would agree with the map: the "
           "receiver's "
           "driver has them the wrong way round";
  }
  if (gnss.fixes == 0) {
    return gnss.outside > 0
               ? "no fix falls between the sweeps: is the receiver's clock another one "
                 "(gnss.time_offset)?"
               : "the receiver had no position";
  }
  if (count(gnss, FixVerdict::impossible) == gnss.fixes) {
    return "not one of them is a position on the Earth";
  }
  if (gnss.yaw_sigma == 0.0) {
    return fmt::format(
        "over {:.0f} m they do not move as the map does: is their time that of the sweeps "
        "(gnss.time_offset), and are they all one antenna's (recording.gnss_topic)?",
        gnss.extent);
  }
  return fmt::format(
      "over {:.0f} m they tell the map's heading to {:.1f} degrees only, or less than "
      "half of them agree; 1 degree is needed: a longer way, or better fixes",
      gnss.extent, gnss.yaw_sigma * 180.0 / std::numbers::pi);
}

}  // namespace

std::string describe(const GnssReport& gnss) {
  const std::size_t used = count(gnss, FixVerdict::used);
  std::string text = fmt::format("{} of {} fixes used", used, gnss.fixes);
  for (const FixVerdict verdict : {FixVerdict::outlier, FixVerdict::frozen, FixVerdict::impossible,
                                   FixVerdict::apart, FixVerdict::waiting, FixVerdict::thinned}) {
    if (count(gnss, verdict) > 0) {
      text += fmt::format(", {} {}", count(gnss, verdict), to_string(verdict));
    }
  }
  if (gnss.without_position > 0) {
    text += fmt::format(", {} without a position", gnss.without_position);
  }
  if (gnss.outside > 0) {
    text += fmt::format(", {} outside of the sweeps' time", gnss.outside);
  }
  if (!gnss.georeference) {
    return text + "; the map has no place in the world: " + why_not(gnss);
  }
  const Georeference& world = *gnss.georeference;
  return text + fmt::format(
                    "; left {:.3f} m level, {:.3f} m in height (rms); map's x axis heads "
                    "{:.2f} degrees (+- {:.2f}), origin {:.7f}, {:.7f}, {:.2f} m",
                    gnss.horizontal, gnss.vertical, heading(world), yaw_sigma(world),
                    world.origin.latitude, world.origin.longitude, world.origin.altitude);
}

nlohmann::ordered_json to_json(const GnssReport& gnss) {
  nlohmann::ordered_json verdicts;
  for (std::size_t i = 0; i < kFixVerdicts; ++i) {
    verdicts[std::string(to_string(static_cast<FixVerdict>(i)))] = gnss.verdicts[i];
  }
  nlohmann::ordered_json json = {{"fixes", gnss.fixes},
                                 {"without_position", gnss.without_position},
                                 {"outside", gnss.outside},
                                 {"verdicts", verdicts},
                                 {"optimizations", gnss.optimizations}};
  if (!gnss.georeference) {
    json["georeference"] = nullptr;
    json["why_not"] = why_not(gnss);
    return json;
  }
  const Georeference& world = *gnss.georeference;
  const Eigen::Vector3d& t = world.T_world_map.translation();
  const Eigen::Quaterniond q(world.T_world_map.linear());
  json["residual_horizontal_m"] = gnss.horizontal;
  json["residual_vertical_m"] = gnss.vertical;
  json["georeference"] = {{"latitude", world.origin.latitude},
                          {"longitude", world.origin.longitude},
                          {"altitude_m", world.origin.altitude},
                          {"T_world_map", {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}},
                          {"heading_deg", heading(world)},
                          {"heading_sigma_deg", yaw_sigma(world)}};
  return json;
}

}  // namespace adit
