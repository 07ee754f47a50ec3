// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/fleet_file.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <span>
#include <string_view>
#include <system_error>

#include <glob.h>

#include "adit/tools/fleet/fleet_plan.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/toml_table.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kMostShards = 100'000;

/// A text of words, or a list of them, which may have spaces.
std::vector<std::string> words_of(const TomlTable& table, std::string_view key) {
  std::vector<std::string> given = table.texts(key);
  if (given.size() != 1) {
    return given;
  }
  std::vector<std::string> words;
  for (const std::string_view word : split_words(given.front())) {
    words.emplace_back(word);
  }
  return words;
}

/// What a path or a pattern stands for, by name.
std::vector<fs::path> matches_of(const std::string& pattern, const fs::path& folder,
                                 const TomlTable& table) {
  const std::string whole = (folder / pattern).string();
  glob_t found{};
  const int result = glob(whole.c_str(), GLOB_TILDE, nullptr, &found);
  std::vector<fs::path> paths;
  for (std::size_t i = 0; result == 0 && i < found.gl_pathc; ++i) {
    paths.push_back(fs::path(found.gl_pathv[i]).lexically_normal());
  }
  globfree(&found);
  if (paths.empty()) {
    table.refuse("there is no " + whole);
  }
  return paths;
}

/// Of a path's last part; "drive/" is drive.
std::string stem_of(const fs::path& path) {
  const fs::path named = path.has_filename() ? path : path.parent_path();
  std::error_code error;
  return (fs::is_directory(named, error) ? named.filename() : named.stem()).string();
}

/// What patterns match besides recordings: an earlier plan, and the fleet's file.
bool is_no_recording(const fs::path& path, const fs::path& file) {
  std::error_code error;
  return has_plan(path) || fs::equivalent(path, file, error);
}

FleetRecording recording_of(std::vector<fs::path> parts, std::vector<std::string> options,
                            const std::optional<std::string>& name, const TomlTable& table) {
  const std::string wanted = name.value_or(stem_of(parts.front()));
  if (wanted.empty() || wanted.starts_with('.') || wanted.find('/') != std::string::npos) {
    table.refuse("'" + wanted + "' cannot be the name of a folder");
  }
  return {.name = wanted,
          .is_named = name.has_value(),
          .parts = std::move(parts),
          .options = std::move(options)};
}

/// Those with tables of their own come first; patterns leave them out.
std::vector<FleetRecording> recordings_in(const TomlTable& table, const fs::path& file) {
  const fs::path folder = file.parent_path();
  std::vector<FleetRecording> recordings;
  std::set<fs::path> taken;
  const std::vector<std::string> options = words_of(table, "run");
  for (const TomlTable& one : table.tables("recording")) {
    constexpr std::array<std::string_view, 3> kKeys = {"path", "name", "run"};
    one.require_only(kKeys, "[[recording]]");
    std::vector<fs::path> parts;
    for (const std::string& path : one.texts("path")) {
      std::ranges::move(matches_of(path, folder, one), std::back_inserter(parts));
    }
    if (parts.empty()) {
      one.refuse("a recording has no path");
    }
    for (const fs::path& part : parts) {
      if (!taken.insert(part).second) {
        one.refuse(part.string() + " is named twice");
      }
    }
    std::vector<std::string> words = options;
    std::ranges::move(words_of(one, "run"), std::back_inserter(words));
    recordings.push_back(recording_of(std::move(parts), std::move(words), one.text("name"), one));
  }
  for (const std::string& pattern : table.texts("recordings")) {
    for (fs::path& path : matches_of(pattern, folder, table)) {
      if (!is_no_recording(path, file) && taken.insert(path).second) {
        recordings.push_back(recording_of({std::move(path)}, options, std::nullopt, table));
      }
    }
  }
  return recordings;
}

std::optional<fs::path> path_in(const TomlTable& table, std::string_view key,
                                const fs::path& folder) {
  const std::optional<std::string> path = table.text(key);
  return path ? std::optional(folder / *path) : std::nullopt;
}

}  // namespace

Fleet read_fleet(const fs::path& file) {
  const TomlFile parsed(read_text_file(file), file, "docs/fleets.md shows a fleet's file");
  const TomlTable table(parsed);
  constexpr std::array<std::string_view, 5> kKeys = {"recordings", "run", "recording", "merge",
                                                     "deliver"};
  table.require_only(kKeys, "a fleet");
  Fleet fleet{.folder = fs::absolute(file).lexically_normal().parent_path()};
  fleet.recordings = recordings_in(table, fs::absolute(file).lexically_normal());
  if (fleet.recordings.size() < 2) {
    table.refuse("it names fewer than two recordings; `adit run` maps one");
  }
  if (const auto merge = table.table("merge")) {
    constexpr std::array<std::string_view, 2> kMergeKeys = {"same_site", "shards"};
    merge->require_only(kMergeKeys, "[merge]");
    fleet.same_site = merge->truth("same_site").value_or(false);
    const auto shards = merge->number("shards").value_or(static_cast<int64_t>(fleet.pair_shards));
    if (shards < 1 || shards > kMostShards) {
      merge->refuse("shards", "shards is not between 1 and 100000");
    }
    fleet.pair_shards = static_cast<std::size_t>(shards);
  }
  std::optional<fs::path> preset;
  if (const auto deliver = table.table("deliver")) {
    constexpr std::array<std::string_view, 4> kDeliverKeys = {"preset", "origin", "crs", "geoid"};
    deliver->require_only(kDeliverKeys, "[deliver]");
    preset = path_in(*deliver, "preset", fleet.folder);
    fleet.place = {.origin = deliver->text("origin"),
                   .crs = deliver->text("crs"),
                   .geoid = path_in(*deliver, "geoid", fleet.folder)};
  }
  fleet.products = preset ? parse_delivery(read_text_file(*preset), *preset)
                          : parse_delivery(default_delivery(), "the built-in preset");
  return fleet;
}

}  // namespace adit
