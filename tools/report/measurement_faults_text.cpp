// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/measurement_faults_text.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace adit {

std::vector<std::string> describe(const MeasurementFaults& faults) {
  std::vector<std::string> sentences;
  const auto add = [&](std::size_t count, const std::string& text) {
    if (count > 0) {
      sentences.push_back(text);
    }
  };
  const auto of_fixes = [&](std::size_t count) {
    return fmt::format("{} of {} fixes", count, faults.fixes);
  };
  add(faults.fixes_left_out, of_fixes(faults.fixes_left_out) + " are not finite and were left out");
  add(faults.fixes_without_height, of_fixes(faults.fixes_without_height) +
                                       " have no altitude; their latitude and longitude were used");
  add(faults.fixes_without_covariance, of_fixes(faults.fixes_without_covariance) +
                                           " have a covariance that is not finite or negative; the "
                                           "usual one of their kind was used");
  add(faults.velocities_left_out,
      fmt::format("{} of {} velocities are infinite or not measured, and were left out",
                  faults.velocities_left_out, faults.velocities));
  add(faults.velocities_without_covariance,
      fmt::format("{} of {} velocities have a covariance that none can be; velocity.sigma was used",
                  faults.velocities_without_covariance, faults.velocities));
  add(faults.headings_left_out, fmt::format("{} of {} headings are not finite and were left out",
                                            faults.headings_left_out, faults.headings));
  add(faults.headings_without_sigma,
      fmt::format("{} of {} headings have a deviation that is not finite or not positive; "
                  "gnss.heading_sigma was used",
                  faults.headings_without_sigma, faults.headings));
  add(faults.intensities,
      fmt::format("the intensity of {} points is not finite; 0 was used", faults.intensities));
  add(faults.times, fmt::format("the time of {} points is not finite or beyond an hour; these "
                                "points were not used in sweeps that were de-skewed",
                                faults.times));
  add(faults.transforms,
      fmt::format("{} static transforms are not finite and were left out", faults.transforms));
  return sentences;
}

nlohmann::ordered_json to_json(const MeasurementFaults& faults) {
  return {{"fixes_left_out", faults.fixes_left_out},
          {"fixes_without_height", faults.fixes_without_height},
          {"fixes_without_covariance", faults.fixes_without_covariance},
          {"velocities_left_out", faults.velocities_left_out},
          {"velocities_without_covariance", faults.velocities_without_covariance},
          {"headings_left_out", faults.headings_left_out},
          {"headings_without_sigma", faults.headings_without_sigma},
          {"point_intensities", faults.intensities},
          {"point_times", faults.times},
          {"static_transforms", faults.transforms}};
}

}  // namespace adit
