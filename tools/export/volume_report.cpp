// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/export/volume_job.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"

namespace adit {
namespace {

using VolumeJson = nlohmann::ordered_json;

constexpr double kMillimetres = 1e3;
constexpr double kCentimetre = 0.01;

/// Whether the errors hold what there is: the offset was measured, or the plane's place was.
bool knows_errors(const VolumeOutcome& outcome) {
  return outcome.stable.has_value() && !outcome.offset_refused;
}

std::string sessions_text(const char* name, const std::vector<ComparedSession>& sessions) {
  std::string text;
  for (const ComparedSession& session : sessions) {
    const std::string begin = is_unix_time(session.first)
                                  ? iso_time(session.first).substr(0, 16) + "Z"
                                  : fmt::format("{:.0f} s", seconds(session.first));
    text += fmt::format("{:9} session {} of {}, {}, {} keyframes\n", name, session.id,
                        session.map.string(), begin, session.keyframes);
  }
  return text;
}

std::string base_text(const VolumeOutcome& outcome) {
  switch (outcome.base) {
    case VolumeBase::tied:
      return "the maps are tied by places that both saw";
    case VolumeBase::sessions:
      return "the sessions are of one map";
    case VolumeBase::georeferenced:
      return fmt::format(
          "the maps lie as on the Earth; their relative height has a standard deviation of {:.0f} "
          "mm",
          kMillimetres * outcome.tie_error.value_or(0.0));
    case VolumeBase::height:
      return fmt::format("a level plane at {:.3f} m", outcome.plane->height);
    case VolumeBase::surroundings:
      break;
  }
  return fmt::format(
      "a plane through the ground within 2 m around: {:.3f} m in its middle, slope {:.2f} degrees",
      outcome.plane->height, std::atan(outcome.plane->slope.norm()) * kDegreesPerRadian);
}

std::string stable_text(const VolumeCommandOptions& options, const VolumeOutcome& outcome) {
  const double centimetre = kCentimetre * outcome.volume.net.area;
  const std::string unknown = fmt::format(
      "a common error of heights of 1 cm would be {:.2f} m3 of net, and is not in its error",
      centimetre);
  if (outcome.base == VolumeBase::height) {
    return "stable    not known: " + unknown + "\n";
  }
  if (!outcome.stable) {
    return "stable    no ground that has stayed: " + unknown + "\n";
  }
  const StableGround& stable = *outcome.stable;
  const bool is_plane = outcome.base == VolumeBase::surroundings;
  std::string text = fmt::format("stable    {:.1f} m2, cells differ by {:.0f} mm (1 sigma)",
                                 stable.area, kMillimetres * stable.spread);
  if (!is_plane) {
    const std::string offset = fmt::format("{:+.1f} +- {:.1f} mm", kMillimetres * stable.offset,
                                           kMillimetres * stable.error_of_mean(stable.area));
    text += outcome.offset_refused
                ? fmt::format(
                      "; it differs by {}, more than errors of the maps explain: that counts as "
                      "changed. --polygon says where the ground has changed",
                      offset)
            : options.as_measured ? fmt::format("; its mean of {} is not taken off", offset)
                                  : fmt::format("; its mean of {} is taken off", offset);
  }
  return text + "\n";
}

std::string volume_line(const char* name, const MeasuredVolume& volume, bool has_sign) {
  const std::string amount =
      has_sign ? fmt::format("{:+.3f}", volume.volume) : fmt::format("{:.3f}", volume.volume);
  return fmt::format("{:9} {} m3 +- {:.3f} ({:.1f} m2)\n", name, amount, volume.error, volume.area);
}

double percent(double part, double whole) {
  return whole > 0.0 ? 100.0 * part / whole : 0.0;
}

VolumeJson to_json(const MeasuredVolume& volume, bool knows_error) {
  return {{"volume_m3", volume.volume},
          {"error_m3", knows_error ? VolumeJson(volume.error) : VolumeJson()},
          {"area_m2", volume.area}};
}

VolumeJson to_json(const std::vector<ComparedSession>& sessions) {
  VolumeJson list = VolumeJson::array();
  for (const ComparedSession& session : sessions) {
    list.push_back({{"id", session.id},
                    {"name", session.name},
                    {"map", session.map.string()},
                    {"keyframes", session.keyframes},
                    {"first_stamp_ns", session.first.count()},
                    {"last_stamp_ns", session.last.count()}});
  }
  return list;
}

const char* name_of(VolumeBase base) {
  switch (base) {
    case VolumeBase::tied:
      return "tied";
    case VolumeBase::sessions:
      return "sessions";
    case VolumeBase::georeferenced:
      return "georeferenced";
    case VolumeBase::height:
      return "height";
    case VolumeBase::surroundings:
      break;
  }
  return "surroundings";
}

}  // namespace

std::string describe_volume(const VolumeCommandOptions& options, const VolumeOutcome& outcome) {
  const GroundVolume& volume = outcome.volume;
  const bool is_plane = !options.above.empty();
  std::string text = sessions_text("before", outcome.before) +
                     sessions_text(is_plane ? "map" : "after", outcome.after);
  text += fmt::format("base      {}\n", base_text(outcome));
  text += stable_text(options, outcome);
  text += volume_line(is_plane ? "above" : "fill", volume.fill, false);
  text += volume_line(is_plane ? "below" : "cut", volume.cut, false);
  text += volume_line("net", volume.net, true);
  text += fmt::format(
      "compared  {:.1f} of {:.1f} m2 {}, in cells of {} m; {:.1f} m2 of that "
      "interpolated\n",
      volume.compared, outcome.area,
      outcome.has_place ? "of the polygon or box" : "that either saw", outcome.cell,
      outcome.closed);
  if (is_plane) {
    text += fmt::format("unseen    {:.1f} m2 ({:.1f} %)\n", outcome.unseen_after,
                        percent(outcome.unseen_after, outcome.area));
  } else {
    text += fmt::format("unseen    before {:.1f} m2 ({:.1f} %), after {:.1f} m2 ({:.1f} %)\n",
                        outcome.unseen_before, percent(outcome.unseen_before, outcome.area),
                        outcome.unseen_after, percent(outcome.unseen_after, outcome.area));
  }
  if (options.raster) {
    text += fmt::format("wrote     {}, in {}\n", options.raster->string(), outcome.coordinates);
  }
  return text;
}

std::string to_json(const VolumeCommandOptions& options, const VolumeOutcome& outcome) {
  const bool knows = knows_errors(outcome);
  const GroundVolume& volume = outcome.volume;
  VolumeJson json = {{"schema", "volume/1"},
                     {"base", name_of(outcome.base)},
                     {"before", to_json(outcome.before)},
                     {"after", to_json(outcome.after)},
                     {"coordinates", outcome.coordinates},
                     {"cell_m", outcome.cell},
                     {"fill", to_json(volume.fill, knows)},
                     {"cut", to_json(volume.cut, knows)},
                     {"net", to_json(volume.net, knows)},
                     {"unchanged_m3", volume.rest},
                     {"area_m2", outcome.area},
                     {"compared_m2", volume.compared},
                     {"interpolated_m2", outcome.closed},
                     {"unseen_before_m2", outcome.unseen_before},
                     {"unseen_after_m2", outcome.unseen_after},
                     {"offset_m", outcome.offset}};
  json["stable"] = VolumeJson();
  if (const auto& stable = outcome.stable) {
    json["stable"] = {{"area_m2", stable->area},
                      {"offset_m", stable->offset},
                      {"offset_error_m", stable->error_of_mean(stable->area)},
                      {"spread_m", stable->spread}};
  }
  json["plane"] = VolumeJson();
  if (const auto& plane = outcome.plane) {
    json["plane"] = {{"height_m", plane->height},
                     {"slope_deg", std::atan(plane->slope.norm()) * kDegreesPerRadian}};
  }
  json["raster"] = options.raster ? VolumeJson(options.raster->string()) : VolumeJson();
  return json.dump(2, ' ', false, VolumeJson::error_handler_t::replace) + "\n";
}

}  // namespace adit
