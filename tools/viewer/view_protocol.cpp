// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_protocol.hpp"

#include <functional>
#include <limits>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/usage_error.hpp"
#include "adit/tools/viewer/view_graph.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

ViewAnswer changed(ViewData& data, int64_t loop, LoopAction action) {
  try {
    const LoopChange change = data.change(loop, action);
    return {.reply = told(fmt::format("Loop {} is {}: cost {:.4g}, now {:.4g}; keyframes moved by "
                                      "up to {:.3f} m.",
                                      change.id, change.what, change.cost_before, change.cost_after,
                                      change.moved),
                          false),
            .to_all = data.graph()};
  } catch (const UsageError& error) {
    return {.reply = told(error.what(), true)};
  } catch (const FileError& error) {
    return {.reply = told(error.what(), true)};
  }
}

bool is_tile_number(const ordered_json& number) {
  return number.is_number_unsigned() &&
         number.get<uint64_t>() <= std::numeric_limits<uint32_t>::max();
}

using Change = std::function<ViewAnswer(int64_t loop, LoopAction action)>;

ViewAnswer answer_with(const Change& change, std::string_view message) {
  const ViewAnswer no_answer{.understood = false};
  const ordered_json json = ordered_json::parse(message, nullptr, false);
  if (!json.is_object() || json.size() != 1) {
    return no_answer;
  }
  const std::string& what = json.begin().key();
  const ordered_json& value = json.begin().value();
  if (what == "tiles" && value.is_array()) {
    ViewAnswer answer;
    for (const ordered_json& number : value) {
      if (!is_tile_number(number)) {
        return no_answer;
      }
      answer.tiles.push_back(number.get<uint32_t>());
    }
    return answer;
  }
  if ((what == "revoke" || what == "restore") && value.is_number_integer()) {
    return change(value.get<int64_t>(),
                  what == "revoke" ? LoopAction::revoke : LoopAction::restore);
  }
  return no_answer;
}

}  // namespace

ViewAnswer answer_to(ViewData& data, std::string_view message) {
  return answer_with([&](int64_t loop, LoopAction action) { return changed(data, loop, action); },
                     message);
}

ViewAnswer answer_while_running(std::string_view message) {
  return answer_with(
      [](int64_t, LoopAction) {
        return ViewAnswer{.reply = told("A run goes on with this map: loops can be edited once it "
                                        "has ended, by `adit view --edit`.",
                                        true)};
      },
      message);
}

std::string told(const std::string& text, bool problem) {
  return text_of({{"type", "told"}, {"problem", problem}, {"text", text}});
}

}  // namespace adit
