// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_protocol.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <stdexcept>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/usage_error.hpp"
#include "adit/tools/viewer/view_graph.hpp"
#include "adit/tools/viewer/view_world.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

ViewAnswer changed(const ViewData& data, const std::function<LoopChange()>& make) {
  try {
    const LoopChange change = make();
    return {.reply = told(fmt::format("Loop {} is {}: cost {:.4g}, now {:.4g}; keyframes moved by "
                                      "up to {:.3f} m.",
                                      change.id, change.what, change.cost_before, change.cost_after,
                                      change.moved),
                          false),
            .to_all = data.graph()};
  } catch (const std::runtime_error& error) {  // UsageError, FileError, and those of the device
    return {.reply = told(error.what(), true)};
  }
}

bool is_tile_number(const ordered_json& number) {
  return number.is_number_unsigned() &&
         number.get<uint64_t>() <= std::numeric_limits<uint32_t>::max();
}

/// What a view does beside sending tiles.
struct Doings {
  std::function<ViewAnswer(int64_t loop, LoopAction action)> change;
  std::function<ViewAnswer(const LoopByHand& loop)> add;
  std::function<std::string(const Eigen::Vector3d& p_map)> place;
};

bool is_place_asked(const ordered_json& value) {
  return value.is_array() && value.size() == 3 &&
         std::ranges::all_of(value, [](const ordered_json& one) { return one.is_number(); });
}

/// Ids of two keyframes.
bool is_pair(const ordered_json& value) {
  return value.is_array() && value.size() == 2 && value[0].is_number_integer() &&
         value[1].is_number_integer();
}

ViewAnswer answer_with(const Doings& doings, std::string_view message) {
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
  if (what == "place" && is_place_asked(value)) {
    return {.reply = doings.place(
                {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()})};
  }
  if ((what == "revoke" || what == "restore") && value.is_number_integer()) {
    return doings.change(value.get<int64_t>(),
                         what == "revoke" ? LoopAction::revoke : LoopAction::restore);
  }
  if (what == "add" && is_pair(value)) {
    return doings.add({.from = value[0].get<NodeId>(), .to = value[1].get<NodeId>()});
  }
  return no_answer;
}

}  // namespace

ViewAnswer answer_to(ViewData& data, std::string_view message) {
  return answer_with(
      {.change =
           [&](int64_t loop, LoopAction action) {
             return changed(data, [&] { return data.change(loop, action); });
           },
       .add = [&](const LoopByHand& loop) { return changed(data, [&] { return data.add(loop); }); },
       .place = [&](const Eigen::Vector3d& p_map) { return data.place(p_map); }},
      message);
}

ViewAnswer answer_while_running(std::string_view message) {
  const std::string refusal =
      "A run goes on with this map: loops can be edited once it has ended, by `adit view --edit`.";
  return answer_with(
      {.change = [&](int64_t, LoopAction) { return ViewAnswer{.reply = told(refusal, true)}; },
       .add = [&](const LoopByHand&) { return ViewAnswer{.reply = told(refusal, true)}; },
       .place = [](const Eigen::Vector3d& p_map) { return place_answer(std::nullopt, p_map); }},
      message);
}

std::string told(const std::string& text, bool problem) {
  return text_of({{"type", "told"}, {"problem", problem}, {"text", text}});
}

}  // namespace adit
