// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/report/loop_reasons.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace adit {

std::string reasons_text(const LoopReasonCounts& counts) {
  std::string text;
  for (std::size_t i = 0; i < kLoopReasons; ++i) {
    if (counts[i] > 0) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", counts[i],
                          to_string(static_cast<LoopReason>(i)));
    }
  }
  return text;
}

nlohmann::ordered_json reasons_to_json(const LoopReasonCounts& counts) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < kLoopReasons; ++i) {
    if (counts[i] > 0) {
      json[std::string(to_string(static_cast<LoopReason>(i)))] = counts[i];
    }
  }
  return json;
}

}  // namespace adit
