// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/gnss_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

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

}  // namespace

std::string why_not_placed(const GnssReport& gnss) {
  if (gnss.jump) {
    return "they give the map two places; map the part before or after the jump alone (--start, "
           "--count)";
  }
  if (gnss.swapped) {
    return "with latitude and longitude exchanged the fixes would agree with the map: the "
           "receiver's "
           "driver has them the wrong way round";
  }
  if (gnss.fixes == 0) {
    return gnss.left_out > 0 ? "no fix has a finite latitude and longitude between the sweeps"
           : gnss.outside > 0
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
  const double sigma = gnss.yaw_sigma * 180.0 / std::numbers::pi;
  if (sigma < 1.0 && 2 * gnss.agreeing < gnss.asked) {
    return fmt::format(
        "only {} of {} fixes agree on one place of it, half are needed: are they all one "
        "antenna's (recording.gnss_topic), and is their time that of the sweeps "
        "(gnss.time_offset)?",
        gnss.agreeing, gnss.asked);
  }
  return fmt::format(
      "over {:.0f} m they estimate the map's heading to {:.1f} degrees, and 1 degree is needed, "
      "from fixes that are 10 m apart at least: a longer path, or better fixes",
      gnss.extent, sigma);
}

namespace {

constexpr std::array<std::string_view, 4> kAntennaParts{"x", "y", "z", "delay"};

bool is_delay(std::size_t part) {
  return part == kDelay;
}

/// "0.42 m (+- 0.04) along the lidar's x".
std::string significant_text(const AntennaParameter& found, std::size_t part) {
  return is_delay(part)
             ? fmt::format("fixes are {:.3f} s (+- {:.3f}) {}", std::abs(found.value), found.sigma,
                           found.value > 0.0 ? "late" : "early")
             : fmt::format(
                   "the antenna sits {:.2f} m (+- {:.2f}) along the lidar's {} from where "
                   "it was taken to be",
                   found.value, found.sigma, kAntennaParts[part]);
}

/// "x -0.01 m (+- 0.02)".
std::string plain_text(const AntennaParameter& found, std::size_t part) {
  if (!found.observable) {
    return std::string(kAntennaParts[part]) + " not observable";
  }
  return is_delay(part) ? fmt::format("delay {:.3f} s (+- {:.3f})", found.value, found.sigma)
                        : fmt::format("{} {:.2f} m (+- {:.2f})", kAntennaParts[part], found.value,
                                      found.sigma);
}

/// The settings that have what was found.
std::string antenna_settings(const AntennaReport& antenna) {
  std::string text;
  if (std::any_of(antenna.parameters.begin(), antenna.parameters.begin() + kDelay,
                  [](const AntennaParameter& found) { return found.significant; })) {
    text = fmt::format("gnss.antenna = [{:.2f}, {:.2f}, {:.2f}]", antenna.p_lidar_antenna.x(),
                       antenna.p_lidar_antenna.y(), antenna.p_lidar_antenna.z());
  }
  if (antenna.parameters[kDelay].significant) {
    text += (text.empty() ? "" : " and ") +
            fmt::format("gnss.time_offset = {:.3f}", antenna.time_offset);
  }
  return text;
}

constexpr double kDegreesOf = 180.0 / std::numbers::pi;

}  // namespace

std::string why_not_used(const HeadingReport& heading) {
  switch (heading.state) {
    case HeadingState::scattered:
      return fmt::format(
          "only {} of {} agree on the map's yaw while it turns, half are needed: are they headings "
          "of this sensor (recording.heading_topic), and is their time that of the sweeps?",
          heading.agreeing, heading.asked);
    case HeadingState::contradicted:
      return fmt::format(
          "they give the map a yaw that is {:.1f} degrees (+- {:.1f}) from the one by its fixes: "
          "is their mounting right (gnss.heading_mounting), and are they against true north?",
          heading.offset.value_or(0.0) * kDegreesOf, heading.offset_sigma * kDegreesOf);
    default:
      return heading.headings == 0 ? "none falls between the sweeps"
                                   : "the map has no place in the world";
  }
}

namespace {

nlohmann::ordered_json antenna_json(const AntennaReport& antenna) {
  nlohmann::ordered_json parts;
  for (std::size_t i = 0; i < kAntennaParts.size(); ++i) {
    const AntennaParameter& found = antenna.parameters[i];
    const nlohmann::ordered_json unknown;
    parts[std::string(kAntennaParts[i]) + (is_delay(i) ? "_s" : "_m")] = {
        {"error", found.observable ? nlohmann::ordered_json(found.value) : unknown},
        {"sigma", found.observable ? nlohmann::ordered_json(found.sigma) : unknown},
        {"observable", found.observable},
        {"significant", found.significant}};
  }
  parts["corrected"] = antenna.corrected;
  parts["antenna_m"] = {antenna.p_lidar_antenna.x(), antenna.p_lidar_antenna.y(),
                        antenna.p_lidar_antenna.z()};
  parts["time_offset_s"] = antenna.time_offset;
  return parts;
}

}  // namespace

std::string describe_antenna(const GnssReport& gnss) {
  if (!gnss.antenna.estimated) {
    return "";
  }
  const auto& parameters = gnss.antenna.parameters;
  std::string significant;
  std::string others;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    std::string& text = parameters[i].significant ? significant : others;
    text +=
        (text.empty() ? "" : ", ") + (parameters[i].significant ? significant_text(parameters[i], i)
                                                                : plain_text(parameters[i], i));
  }
  if (significant.empty()) {
    return "no error of its place or its time is beyond doubt: " + others;
  }
  const std::string rest = others.empty() ? "" : "; " + others;
  return gnss.antenna.corrected
             ? significant +
                   fmt::format(
                       ": corrected here (chi squared {:.0f}, it was {:.0f}), and from the "
                       "start by ",
                       gnss.antenna.cost_after, gnss.antenna.cost_before) +
                   antenna_settings(gnss.antenna) + rest
             : significant +
                   ", but so corrected the map agrees with them no better: it is left as it is; "
                   "check the antenna's place, gnss.antenna, and the receiver's time, "
                   "gnss.time_offset" +
                   rest;
}

std::string describe(const ReceiverJump& jump) {
  return fmt::format(
      "the receiver jumps by {:.1f} m, {:.1f} s after its first fix: {} fixes before and {} after "
      "the jump agree with the map, each group by itself",
      jump.distance, jump.time, jump.before, jump.after);
}

bool is_refused(const HeadingReport& heading) {
  return heading.state == HeadingState::scattered || heading.state == HeadingState::contradicted;
}

std::string describe(const HeadingReport& heading) {
  if (heading.headings + heading.outside + heading.left_out == 0) {
    return "";
  }
  const auto count = [&](HeadingVerdict verdict) {
    return heading.verdicts[static_cast<std::size_t>(verdict)];
  };
  std::string text =
      fmt::format("{} of {} headings used", count(HeadingVerdict::used), heading.headings);
  for (std::size_t i = 0; i < kHeadingVerdicts; ++i) {
    const auto verdict = static_cast<HeadingVerdict>(i);
    if (verdict != HeadingVerdict::used && count(verdict) > 0) {
      text += fmt::format(", {} {}", count(verdict), to_string(verdict));
    }
  }
  if (heading.left_out > 0) {
    text += fmt::format(", {} not finite", heading.left_out);
  }
  if (heading.outside > 0) {
    text += fmt::format(", {} outside of the sweeps' time", heading.outside);
  }
  if (is_refused(heading)) {
    return text + "; the source is refused: " + why_not_used(heading);
  }
  if (heading.state != HeadingState::used) {
    return text + "; " + why_not_used(heading);
  }
  text += fmt::format("; left {:.2f} degrees (rms)", heading.innovation * kDegreesOf);
  if (heading.offset) {
    text += fmt::format(", {:.2f} degrees (+- {:.2f}) from the yaw by fixes alone",
                        *heading.offset * kDegreesOf, heading.offset_sigma * kDegreesOf);
  }
  return text + (heading.placed ? "; the map's first place came by them" : "");
}

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
  if (gnss.left_out > 0) {
    text += fmt::format(", {} not finite", gnss.left_out);
  }
  if (gnss.outside > 0) {
    text += fmt::format(", {} outside of the sweeps' time", gnss.outside);
  }
  if (gnss.jump) {
    text += "; " + describe(*gnss.jump);
  }
  if (!gnss.georeference) {
    return text + "; the map has no place in the world: " + why_not_placed(gnss);
  }
  const Georeference& world = *gnss.georeference;
  const std::string height =
      gnss.heights > 0 ? fmt::format(", {:.3f} m in height (rms)", gnss.vertical)
                       : " (rms), the height is not known: no fix that was used has an altitude";
  return text + fmt::format(
                    "; left {:.3f} m level{}; map's x axis heads "
                    "{:.2f} degrees (+- {:.2f}), origin {:.7f}, {:.7f}, {:.2f} m",
                    gnss.horizontal, height, heading(world), yaw_sigma(world),
                    world.origin.latitude, world.origin.longitude, world.origin.altitude);
}

nlohmann::ordered_json to_json(const HeadingReport& heading) {
  nlohmann::ordered_json verdicts;
  for (std::size_t i = 0; i < kHeadingVerdicts; ++i) {
    verdicts[std::string(to_string(static_cast<HeadingVerdict>(i)))] = heading.verdicts[i];
  }
  const nlohmann::ordered_json unknown;
  return {{"headings", heading.headings},
          {"outside", heading.outside},
          {"not_finite", heading.left_out},
          {"state", to_string(heading.state)},
          {"verdicts", verdicts},
          {"asked", heading.asked},
          {"agreeing", heading.agreeing},
          {"innovation_deg", heading.state == HeadingState::used
                                 ? nlohmann::ordered_json(heading.innovation * kDegreesOf)
                                 : unknown},
          {"offset_deg",
           heading.offset ? nlohmann::ordered_json(*heading.offset * kDegreesOf) : unknown},
          {"offset_sigma_deg",
           heading.offset ? nlohmann::ordered_json(heading.offset_sigma * kDegreesOf) : unknown},
          {"placed_the_map", heading.placed},
          {"text", describe(heading)}};
}

nlohmann::ordered_json to_json(const GnssReport& gnss) {
  nlohmann::ordered_json verdicts;
  for (std::size_t i = 0; i < kFixVerdicts; ++i) {
    verdicts[std::string(to_string(static_cast<FixVerdict>(i)))] = gnss.verdicts[i];
  }
  nlohmann::ordered_json json = {{"fixes", gnss.fixes},
                                 {"without_position", gnss.without_position},
                                 {"outside", gnss.outside},
                                 {"not_finite", gnss.left_out},
                                 {"verdicts", verdicts},
                                 {"optimizations", gnss.optimizations},
                                 {"level_drift_scale", gnss.level_drift_scale}};
  if (gnss.jump) {
    json["jump"] = {{"after_s", gnss.jump->time},
                    {"distance_m", gnss.jump->distance},
                    {"fixes_before", gnss.jump->before},
                    {"fixes_after", gnss.jump->after}};
  }
  if (!describe(gnss.heading).empty()) {
    json["headings"] = to_json(gnss.heading);
  }
  if (!gnss.georeference) {
    json["georeference"] = nullptr;
    json["why_not"] = why_not_placed(gnss);
    return json;
  }
  if (gnss.antenna.estimated) {
    json["antenna"] = antenna_json(gnss.antenna);
    json["antenna"]["text"] = describe_antenna(gnss);
  }
  const Georeference& world = *gnss.georeference;
  const Eigen::Vector3d& t = world.T_world_map.translation();
  const Eigen::Quaterniond q(world.T_world_map.linear());
  json["residual_horizontal_m"] = gnss.horizontal;
  json["residual_vertical_m"] =
      gnss.heights > 0 ? nlohmann::ordered_json(gnss.vertical) : nlohmann::ordered_json();
  json["georeference"] = {{"latitude", world.origin.latitude},
                          {"longitude", world.origin.longitude},
                          {"altitude_m", world.origin.altitude},
                          {"T_world_map", {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}},
                          {"heading_deg", heading(world)},
                          {"heading_sigma_deg", yaw_sigma(world)}};
  return json;
}

}  // namespace adit
