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
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/toml.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFleetRemedy = "docs/fleets.md shows a fleet's file";

/// One table of the file; each wrong value is refused with its line.
class Table {
 public:
  Table(const toml::table& table, const fs::path& file) : table_(&table), file_(&file) {}

  /// Throws InputError where another key is there.
  void require_only(std::span<const std::string_view> names, std::string_view where) const {
    for (const auto& [key, value] : *table_) {
      if (std::ranges::count(names, key.str()) == 0) {
        std::string known;
        for (const std::string_view name : names) {
          known += (known.empty() ? "" : ", ") + std::string(name);
        }
        refuse(value, "'" + std::string(key.str()) + "' is unknown " + std::string(where) +
                          "; there are " + known);
      }
    }
  }

  template <class T>
  std::optional<T> find(std::string_view key, const char* what) const {
    const toml::node* const node = table_->get(key);
    if (node == nullptr) {
      return std::nullopt;
    }
    const std::optional<T> value = node->value_exact<T>();
    if (!value) {
      refuse(*node, std::string(key) + " is no " + what);
    }
    return value;
  }
  std::optional<std::string> text(std::string_view key) const {
    return find<std::string>(key, "text");
  }

  /// One text or a list of texts.
  std::vector<std::string> texts(std::string_view key) const {
    const toml::node* const node = table_->get(key);
    if (node == nullptr) {
      return {};
    }
    if (const auto one = node->value_exact<std::string>()) {
      return {*one};
    }
    std::vector<std::string> all;
    const toml::array* const list = node->as_array();
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
      const auto one = (*list)[i].value_exact<std::string>();
      if (!one) {
        refuse((*list)[i], std::string(key) + " has something that is no text");
      }
      all.push_back(*one);
    }
    if (list == nullptr) {
      refuse(*node, std::string(key) + " is no list of texts");
    }
    return all;
  }

  /// A table in it; empty where there is none.
  Table table(std::string_view key) const {
    static const toml::table nothing;
    const toml::node* const node = table_->get(key);
    if (node != nullptr && node->as_table() == nullptr) {
      refuse(*node, std::string(key) + " is no table");
    }
    return {node == nullptr ? nothing : *node->as_table(), *file_};
  }
  /// The tables of a list of them.
  std::vector<Table> tables(std::string_view key) const {
    std::vector<Table> all;
    const toml::node* const node = table_->get(key);
    const toml::array* const list = node == nullptr ? nullptr : node->as_array();
    if (node != nullptr && (list == nullptr || !list->is_array_of_tables())) {
      refuse(*node, std::string(key) + " is written [[" + std::string(key) + "]]");
    }
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
      all.emplace_back(*(*list)[i].as_table(), *file_);
    }
    return all;
  }

  [[noreturn]] void refuse(const std::string& found) const { refuse(*table_, found); }

 private:
  [[noreturn]] void refuse(const toml::node& node, const std::string& found) const {
    throw InputError(*file_, Place::line(node.source().begin.line), found, kFleetRemedy);
  }

  const toml::table* table_;
  const fs::path* file_;
};

/// A text of words, or a list of them, which may have spaces.
std::vector<std::string> words_of(const Table& table, std::string_view key) {
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
                                 const Table& table) {
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
                            const std::optional<std::string>& name, const Table& table) {
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
std::vector<FleetRecording> recordings_in(const Table& table, const fs::path& file) {
  const fs::path folder = file.parent_path();
  std::vector<FleetRecording> recordings;
  std::set<fs::path> taken;
  const std::vector<std::string> options = words_of(table, "run");
  for (const Table& one : table.tables("recording")) {
    constexpr std::array<std::string_view, 3> kKeys = {"path", "name", "run"};
    one.require_only(kKeys, "in [[recording]]");
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

std::optional<fs::path> path_in(const Table& table, std::string_view key, const fs::path& folder) {
  const std::optional<std::string> path = table.text(key);
  return path ? std::optional(folder / *path) : std::nullopt;
}

}  // namespace

Fleet read_fleet(const fs::path& file) {
  toml::table parsed;
  try {
    parsed = toml::parse(read_text_file(file));
  } catch (const toml::parse_error& error) {
    throw InputError(file, Place::line(error.source().begin.line),
                     "it is no TOML: " + std::string(error.description()), kFleetRemedy);
  }
  const Table table(parsed, file);
  constexpr std::array<std::string_view, 5> kKeys = {"recordings", "run", "recording", "merge",
                                                     "deliver"};
  table.require_only(kKeys, "in a fleet");
  Fleet fleet{.folder = fs::absolute(file).lexically_normal().parent_path()};
  fleet.recordings = recordings_in(table, fs::absolute(file).lexically_normal());
  if (fleet.recordings.size() < 2) {
    table.refuse("it names fewer than two recordings; `adit run` maps one");
  }
  const Table merge = table.table("merge");
  constexpr std::array<std::string_view, 2> kMergeKeys = {"same_site", "shards"};
  merge.require_only(kMergeKeys, "in [merge]");
  fleet.same_site = merge.find<bool>("same_site", "true or false").value_or(false);
  const int64_t shards = merge.find<int64_t>("shards", "whole number")
                             .value_or(static_cast<int64_t>(fleet.pair_shards));
  if (shards < 1 || shards > 100'000) {
    merge.refuse("shards is not between 1 and 100000");
  }
  fleet.pair_shards = static_cast<std::size_t>(shards);
  const Table deliver = table.table("deliver");
  constexpr std::array<std::string_view, 4> kDeliverKeys = {"preset", "origin", "crs", "geoid"};
  deliver.require_only(kDeliverKeys, "in [deliver]");
  const std::optional<fs::path> preset = path_in(deliver, "preset", fleet.folder);
  fleet.products = preset ? parse_delivery(read_text_file(*preset), *preset)
                          : parse_delivery(default_delivery(), "the built-in preset");
  fleet.place = {.origin = deliver.text("origin"),
                 .crs = deliver.text("crs"),
                 .geoid = path_in(deliver, "geoid", fleet.folder)};
  return fleet;
}

}  // namespace adit
