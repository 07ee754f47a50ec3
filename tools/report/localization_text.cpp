// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/localization_text.hpp"

#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace adit {

nlohmann::ordered_json to_json(const Localization& localization) {
  nlohmann::ordered_json json = {{"state", to_string(localization.state)},
                                 {"recognised_loops", localization.recognised},
                                 {"start", to_string(localization.start)},
                                 {"start_contradicted", localization.start_contradicted}};
  if (localization.recognised > 0) {
    json["recognised_after_m"] = localization.searched;
    json["path_since_m"] = localization.path;
  }
  json["keyframes"] = nlohmann::ordered_json::object();
  for (std::size_t i = 1; i < kLocalizationStates; ++i) {
    json["keyframes"][std::string(to_string(static_cast<LocalizationState>(i)))] =
        localization.keyframes[i];
  }
  return json;
}

std::string describe(const Localization& localization) {
  const bool is_expected =
      localization.start != StartSource::appearance && !localization.start_contradicted;
  const std::string expected = localization.start == StartSource::guess ? "--pose" : "GNSS";
  if (localization.recognised == 0) {
    return fmt::format("no place of the map was recognised on {:.0f} m: poses are {}",
                       localization.searched,
                       is_expected ? "where " + expected + " has them, which nothing confirms"
                                   : "in a frame of the run's own");
  }
  std::string text = fmt::format(
      "recognised after {:.1f} m, {}{} loops to the map; keyframes: ", localization.searched,
      localization.start == StartSource::appearance ? ""
      : is_expected                                 ? "where " + expected + " expected it, "
                                                    : "elsewhere than " + expected + " said, ",
      localization.recognised);
  bool first = true;
  for (std::size_t i = 1; i < kLocalizationStates; ++i) {
    if (localization.keyframes[i] > 0) {
      text += fmt::format("{}{} {}", first ? "" : ", ", localization.keyframes[i],
                          to_string(static_cast<LocalizationState>(i)));
      first = false;
    }
  }
  return text;
}

}  // namespace adit
