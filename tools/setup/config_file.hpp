// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Configurations as TOML. Sections, keys, units and help come from Config::visit().
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/core/config.hpp"

namespace adit {

/// A whole configuration that is kept somewhere.
struct KeptConfig {
  std::filesystem::path origin;  ///< for messages
  std::string toml;
};

/// Where a configuration comes from: defaults or one that is kept, then the preset, the file and
/// the overrides.
struct ConfigSource {
  std::optional<std::filesystem::path> file;
  std::vector<std::string> overrides;     ///< "section.key=value", the last one of a key wins
  std::string preset{};                   ///< a name in presets.hpp; empty: none
  std::optional<std::string> metadata{};  ///< recording.metadata; none: as the others say
  std::optional<KeptConfig> kept{};       ///< in place of the defaults
};

/// Reads and validates. Throws InputError with line and column for what the file says, UsageError
/// for what an override says: syntax, an unknown name (with the nearest valid one), a wrong type, a
/// value that validate() refuses.
Config load_config(const ConfigSource& source);

/// Where its settings come from, in the order in which one takes the place of another, for people.
std::string describe(const ConfigSource& source);

/// "section.key=value" of every setting that is none of the defaults, in the order of the file.
std::vector<std::string> changed_settings(const Config& config);

/// What to_toml() wrote; `origin` is for messages. Throws InputError as load_config() does.
Config parse_config(const std::string& toml, const std::filesystem::path& origin);

/// The whole configuration as TOML, each setting with its unit, help and default as a comment.
/// load_config() gives the same configuration back, bit for bit.
std::string to_toml(const Config& config);

/// The same as an object of objects, in the order of the file.
nlohmann::ordered_json to_json(const Config& config);

}  // namespace adit
