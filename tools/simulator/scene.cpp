// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/simulator/scene.hpp"

#include <algorithm>
#include <array>

#include "tools/nearest_name.hpp"
#include "tools/usage_error.hpp"

namespace adit {
namespace {

struct Entry {
  std::string_view name;
  Scene (*make)(uint64_t seed);
};
constexpr std::array kEntries{Entry{"city", make_city},     Entry{"field", make_field},
                              Entry{"forest", make_forest}, Entry{"mine", make_mine},
                              Entry{"office", make_office}, Entry{"room", make_room}};

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kEntries) {
    names.emplace_back(entry.name);
  }
  return names;
}

void require_scene(std::string_view name) {
  if (std::ranges::find(kEntries, name, &Entry::name) == kEntries.end()) {
    throw UsageError("there is no scene '" + std::string(name) + "'. " +
                     suggestion(std::string(name), scene_names()) + ".");
  }
}

Scene make_scene(std::string_view name, uint64_t seed) {
  require_scene(name);
  Scene scene = std::ranges::find(kEntries, name, &Entry::name)->make(seed);
  scene.name = name;
  return scene;
}

}  // namespace adit
