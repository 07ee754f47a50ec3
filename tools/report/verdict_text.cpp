// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/verdict_text.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/nav_state.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kNamed = 5;  // stretches in the text; all are in the JSON
// Nobody records on after a pause that is longer, s.
constexpr double kNoPause = 86400.0;

std::string new_start_text(const DoubtfulStretch& stretch) {
  const std::string why =
      stretch.silence > 0.0
          ? fmt::format("no sweep was aligned for {:.1f} s{}, and the map began anew after it: ",
                        stretch.silence,
                        stretch.silence > kNoPause ? " (or the clock was set forward)" : "")
          : std::string("no sweep could be aligned, and the map began anew after it: ");
  if (stretch.tied) {
    return why + "loops or GNSS alone tie its pieces";
  }
  return why + (stretch.trust == Trust::lost
                    ? "how its pieces lie to each other is a guess; loops or GNSS can tie them, or "
                      "map them apart with --start and --count"
                    : "the IMU alone tells how its pieces lie to each other; loops or GNSS would "
                      "confirm it");
}

std::string cause_text(const DoubtfulStretch& stretch) {
  const Eigen::Vector3d& d = stretch.direction;
  switch (stretch.cause) {
    case DoubtCause::unheld:
      return (d.isZero() ? "it turned about what no match held"
                         : fmt::format("no match held it along ({:.2f}, {:.2f}, {:.2f}) of the map",
                                       d.x(), d.y(), d.z())) +
             (stretch.inertial()
                  ? fmt::format(", the IMU alone did, to {:.2f} m (one sigma); loops or GNSS would "
                                "tell",
                                stretch.sigma)
              : stretch.by_velocities()
                  ? ", measured velocities alone did, before the IMU had started: nothing has "
                    "compared their scale; begin at rest, or where more is in sight"
                  : ", and no IMU did: its position in that direction is a guess; fuse an IMU, "
                    "or use a sensor that sees farther");
    case DoubtCause::predicted:
      return std::string("no sweep could be aligned: ") +
             (stretch.inertial() ? "the IMU alone carried it" : "its last velocity carried it on") +
             "; `adit inspect` tells whether the recording is damaged there";
    case DoubtCause::contradicted:
      if (stretch.innovation <= 0.0) {
        return "alignments contradict each other, with steps that no sensor makes: it turned or "
               "moved faster than they can follow, or matched the wrong place; fuse an IMU, or "
               "move more slowly";
      }
      return fmt::format(
          "alignments and IMU contradict each other, innovations squared are {:.0f} times what "
          "they should be; `adit inspect` holds the IMU's clock, mounting and units against the "
          "sweeps, and imu.use=false maps without it",
          stretch.innovation);
    case DoubtCause::new_start:
      return new_start_text(stretch);
    case DoubtCause::silence:
      return fmt::format(
          "no sweep was aligned for {:.1f} s, and no IMU bridges that; the next one fits the map "
          "where the sensor can have moved to, and nothing else confirms it",
          stretch.silence);
  }
  return "";
}

}  // namespace

std::string describe(const MovedByLoops& moved) {
  return fmt::format(
      "loops moved the map by {:.2f} m over a path of {:.0f} m, {:.1f} standard deviations of the "
      "odometry (at most {:.0f} are reliable): a place that looks alike may have been taken for "
      "it; "
      "`adit loops OUT/map.adit` lists them, and --revoke takes one back",
      moved.distance, moved.path, moved.sigmas, kMostLoopSigmas);
}

std::string describe(const DoubtfulStretch& stretch, Nanoseconds start) {
  return fmt::format("{:.1f} to {:.1f} s (sweeps {} to {}, {:.1f} m), ",
                     seconds(stretch.begin - start), seconds(stretch.end - start), stretch.first,
                     stretch.last, stretch.distance) +
         std::string(to_string(stretch.trust)) + ": " + cause_text(stretch);
}

std::string describe(const RunAssessment& assessment, Nanoseconds start, std::size_t indent) {
  if (assessment.trust == Trust::reliable) {
    const std::size_t missing = assessment.coverage.missing();
    return "reliable: no sweep is in doubt" +
           (missing == 0 ? std::string()
                         : fmt::format("; {} of {} sweeps are not in the trajectory", missing,
                                       assessment.coverage.sweeps));
  }
  const std::string line = "\n" + std::string(indent, ' ');
  std::string text(to_string(assessment.trust));
  for (const VerdictReason& reason : assessment.reasons) {
    text += line + reason.text;
  }
  const std::size_t named = std::min(kNamed, assessment.stretches.size());
  for (std::size_t i = 0; i < named; ++i) {
    text += line + describe(assessment.stretches[i], start);
  }
  return assessment.stretches.size() == named
             ? text
             : text + line +
                   fmt::format("and {} more, see summary.json",
                               assessment.stretches.size() - named);
}

ordered_json to_json(const RunAssessment& assessment, Nanoseconds start) {
  const Coverage& coverage = assessment.coverage;
  ordered_json json = {{"state", to_string(assessment.trust)},
                       {"coverage",
                        {{"sweeps", coverage.sweeps},
                         {"placed", coverage.placed},
                         {"missing", coverage.missing()},
                         {"longest_missing", coverage.longest},
                         {"longest_missing_s", coverage.longest_seconds}}},
                       {"reasons", ordered_json::array()},
                       {"stretches", ordered_json::array()}};
  if (assessment.moved) {
    json["moved_by_loops"] = {{"distance_m", assessment.moved->distance},
                              {"sigmas", assessment.moved->sigmas},
                              {"path_m", assessment.moved->path},
                              {"text", describe(*assessment.moved)}};
  }
  for (const VerdictReason& reason : assessment.reasons) {
    json["reasons"].push_back(
        {{"state", to_string(reason.trust)}, {"cause", reason.cause}, {"text", reason.text}});
  }
  for (const DoubtfulStretch& stretch : assessment.stretches) {
    const Eigen::Vector3d& d = stretch.direction;
    json["stretches"].push_back(
        {{"state", to_string(stretch.trust)},
         {"cause", to_string(stretch.cause)},
         {"begin_s", seconds(stretch.begin - start)},
         {"end_s", seconds(stretch.end - start)},
         {"first_sweep", stretch.first},
         {"last_sweep", stretch.last},
         {"distance_m", stretch.distance},
         {"imu_fused", stretch.inertial()},
         {"silence_s", stretch.silence > 0.0 ? ordered_json(stretch.silence) : ordered_json()},
         {"sigma_m", stretch.sigma},
         {"direction_map", d.isZero() ? ordered_json() : ordered_json{d.x(), d.y(), d.z()}},
         {"innovation_squared_per_degree",
          stretch.innovation > 0.0 ? ordered_json(stretch.innovation) : ordered_json()},
         {"text", describe(stretch, start)}});
  }
  return json;
}

}  // namespace adit
