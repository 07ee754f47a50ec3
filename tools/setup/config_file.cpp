// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/config_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "adit/tools/setup/presets.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/toml.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// A complaint about a place in a text, before it is known whether the text is a file or an option.
struct Complaint {
  toml::source_position where;
  std::string found;
  std::string remedy;
};

/// Where each setting was given, by dotted name.
using Origins = std::map<std::string, toml::source_position>;

std::string place(const toml::source_position& where) {
  return "line " + std::to_string(where.line) + ", column " + std::to_string(where.column);
}

// ---- the names, units and help of Config::visit() ----

std::vector<std::string> section_names() {
  std::vector<std::string> names;
  const Config config;
  Config::visit(config, [&](const char* section, const auto&) { names.emplace_back(section); });
  return names;
}

/// An empty optional is null: a setting that is not given.
template <class Value>
nlohmann::ordered_json json_of(const Value& value) {
  return value;
}
template <class Value>
nlohmann::ordered_json json_of(const std::optional<Value>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

template <class Fields>
std::vector<std::string> key_names(const Fields& fields) {
  std::vector<std::string> names;
  Fields::visit(fields, [&](const char* name, auto&&...) { names.emplace_back(name); });
  return names;
}

// ---- TOML to Config ----

std::string type_name(const toml::node& node) {
  std::ostringstream text;
  text << node.type();
  if (const auto given = node.value<std::string>(); given && node.is_string()) {
    return "the text '" + *given + "'";
  }
  return node.is_table() ? "a section" : "of type " + text.str();
}

void assign(double& to, const toml::node& node) {
  const auto value = node.value<double>();
  if (!value || node.is_boolean()) {
    throw Complaint{node.source().begin, "is " + type_name(node), "Write a number, such as 0.5"};
  }
  to = *value;
}

void assign(int& to, const toml::node& node) {
  const auto value = node.is_integer() ? node.value<int64_t>() : std::nullopt;
  if (!value) {
    throw Complaint{node.source().begin, "is " + type_name(node),
                    "Write a whole number, such as 10"};
  }
  if (*value < std::numeric_limits<int>::min() || *value > std::numeric_limits<int>::max()) {
    throw Complaint{node.source().begin, "is " + std::to_string(*value), "Write a smaller number"};
  }
  to = static_cast<int>(*value);
}

/// Also 0 and 1, which switches were before they were booleans.
void assign(bool& to, const toml::node& node) {
  const auto number = node.is_integer() ? node.value<int64_t>() : std::nullopt;
  if (!node.is_boolean() && !(number && (*number == 0 || *number == 1))) {
    throw Complaint{node.source().begin, "is " + type_name(node), "Write true or false"};
  }
  to = number ? *number == 1 : *node.value<bool>();
}

void assign(std::string& to, const toml::node& node) {
  const auto value = node.value<std::string>();
  if (!value) {
    throw Complaint{node.source().begin, "is " + type_name(node),
                    "Write a text in quotes, such as \"/points\""};
  }
  to = *value;
}

template <std::size_t n>
void assign(std::array<double, n>& to, const toml::node& node) {
  const toml::array* values = node.as_array();
  if (values == nullptr || values->size() != n) {
    throw Complaint{node.source().begin, "is " + type_name(node),
                    "Write " + std::to_string(n) + " numbers in brackets: [1.0, 2.0, ...]"};
  }
  for (std::size_t i = 0; i < n; ++i) {
    assign(to[i], *values->get(i));
  }
}

template <class Value>
void assign(std::vector<Value>& to, const toml::node& node) {
  const toml::array* values = node.as_array();
  if (values == nullptr) {
    throw Complaint{node.source().begin, "is " + type_name(node), "Write a list in brackets"};
  }
  to.clear();
  for (const toml::node& value : *values) {
    assign(to.emplace_back(), value);
  }
}

template <class Value>
void assign(std::optional<Value>& to, const toml::node& node) {
  assign(to.emplace(), node);
}

template <class Fields>
void read_section(Fields& fields, const std::string& section, const toml::table& table,
                  Origins& origins) {
  for (const auto& entry : table) {
    const toml::key& key = entry.first;
    const toml::node& node = entry.second;
    const std::string dotted = section + "." + std::string(key.str());
    bool known = false;
    Fields::visit(fields, [&](std::string_view name, auto& value, auto&&...) {
      if (name != key.str()) {
        return;
      }
      known = true;
      try {
        assign(value, node);
      } catch (Complaint& complaint) {
        complaint.found = dotted + " " + complaint.found;
        throw;
      }
      origins[dotted] = key.source().begin;
    });
    if (!known) {
      throw Complaint{key.source().begin, "there is no setting '" + dotted + "'",
                      suggestion(key.str(), key_names(fields), section + ".")};
    }
  }
}

void read_table(Config& config, const toml::table& table, Origins& origins) {
  for (const auto& entry : table) {
    const toml::key& key = entry.first;
    const toml::node& node = entry.second;
    bool known = false;
    Config::visit(config, [&](std::string_view section, auto& fields) {
      if (section != key.str()) {
        return;
      }
      known = true;
      if (!node.is_table()) {
        throw Complaint{node.source().begin, "'" + std::string(section) + "' is " + type_name(node),
                        "Write [" + std::string(section) + "] and its settings below"};
      }
      read_section(fields, std::string(section), *node.as_table(), origins);
    });
    if (!known) {
      throw Complaint{key.source().begin, "there is no section '" + std::string(key.str()) + "'",
                      suggestion(key.str(), section_names())};
    }
  }
}

/// The origin of the setting a problem is about or, where that one has its default, of one the
/// message names.
const Origins::value_type* origin_of(const ConfigProblem& problem, const Origins& origins) {
  if (const auto at = origins.find(problem.field); at != origins.end()) {
    return &*at;
  }
  for (const auto& origin : origins) {
    if (problem.message.find(origin.first) != std::string::npos) {
      return &origin;
    }
  }
  return nullptr;
}

// ---- the two sources ----

std::string read_text(const fs::path& file) {
  std::error_code error;
  if (fs::is_directory(file, error)) {
    throw InputError(file, Place(), "is a folder, not a configuration", "Name a TOML file");
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf() || stream.peek() == EOF)) {
    throw InputError(file, Place(), "cannot be read", "Check the path and its permissions");
  }
  const std::string whole = text.str();
  return whole.substr(start_of_text(file, whole));
}

/// InputError ends both parts with a full stop.
std::string without_stop(std::string text) {
  if (!text.empty() && text.back() == '.') {
    text.pop_back();
  }
  return text;
}

/// `file` is for messages.
Origins apply_text(Config& config, const std::string& text, const fs::path& file) {
  Origins origins;
  try {
    read_table(config, toml::parse(text), origins);
  } catch (const toml::parse_error& error) {
    throw InputError(file, Place::named(place(error.source().begin)),
                     "not valid TOML: " + without_stop(std::string(error.description())),
                     "`adit config` prints a valid file");
  } catch (const Complaint& complaint) {
    throw InputError(file, Place::named(place(complaint.where)), complaint.found, complaint.remedy);
  }
  return origins;
}

/// A shell takes quotes away, so that a text may come without them: imu.sensor=vn100.
toml::table parsed_override(const std::string& section, const std::string& key,
                            const std::string& value) {
  const std::string line = "[" + section + "]\n" + key + " = ";
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("/_-.").find(static_cast<char>(c)) != std::string_view::npos;
  };
  try {
    return toml::parse(line + value);
  } catch (const toml::parse_error&) {
    if (value.empty() || !std::ranges::all_of(value, plain)) {
      throw;
    }
  }
  return toml::parse(line + "\"" + value + "\"");
}

/// Applies "section.key=value" and returns the dotted name.
std::string apply_override(Config& config, const std::string& text) {
  const auto refuse = [&](const std::string& why) {
    throw UsageError("--set " + text + ": " + why);
  };
  const std::size_t equals = text.find('=');
  const std::size_t dot = text.find('.');
  const bool one_line = text.find_first_of("\r\n") == std::string::npos;
  if (equals == std::string::npos || dot == std::string::npos || dot > equals || !one_line) {
    refuse("write it as section.key=value, for example preprocess.r_input=0.5");
  }
  const auto bare = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  const std::string section = text.substr(0, dot);
  const std::string key = text.substr(dot + 1, equals - dot - 1);
  if (!std::ranges::all_of(section, bare) || !std::ranges::all_of(key, bare) || key.empty()) {
    refuse("write it as section.key=value, without spaces");
  }
  try {
    Origins origins;
    read_table(config, parsed_override(section, key, text.substr(equals + 1)), origins);
  } catch (const toml::parse_error&) {
    refuse("'" + text.substr(equals + 1) + "' is not a value. Write a number, a text, or a list.");
  } catch (const Complaint& complaint) {
    refuse(complaint.found + ". " + complaint.remedy + ".");
  }
  return section + "." + key;
}

/// Older versions kept densities that only a custom sensor has, though another one was named.
void forget_unused(ImuConfig& imu) {
  if (imu.sensor != "custom") {
    const ImuConfig usual;
    imu.gyro_noise = usual.gyro_noise;
    imu.accel_noise = usual.accel_noise;
    imu.gyro_walk = usual.gyro_walk;
    imu.accel_walk = usual.accel_walk;
  }
}

}  // namespace

std::string describe(const ConfigSource& source) {
  std::string text = source.kept ? "those of " + source.kept->origin.string() : "defaults";
  if (!source.preset.empty()) {
    text += ", preset " + source.preset;
  }
  if (source.file) {
    text += ", " + source.file->string();
  }
  for (const std::string& one : source.overrides) {
    text += ", " + one;
  }
  return text;
}

std::vector<std::string> changed_settings(const Config& config) {
  std::vector<std::string> changed;
  const nlohmann::ordered_json defaults = to_json(Config{});
  const nlohmann::ordered_json settings = to_json(config);
  for (const auto& [section, keys] : settings.items()) {
    for (const auto& [key, value] : keys.items()) {
      if (value != defaults[section][key]) {
        changed.push_back(section + "." + key + "=" + value.dump());
      }
    }
  }
  return changed;
}

Config parse_config(const std::string& toml, const fs::path& origin) {
  Config config;
  apply_text(config, toml, origin);
  forget_unused(config.imu);
  if (const auto problem = validate(config)) {
    throw InputError(origin, {}, problem->field + " " + problem->message,
                     "`adit config` prints every setting with its unit and default");
  }
  return config;
}

Config load_config(const ConfigSource& source) {
  Config config = source.kept ? parse_config(source.kept->toml, source.kept->origin) : Config{};
  Origins origins;
  if (!source.preset.empty()) {
    apply_preset(source.preset, config);
  }
  if (source.file) {
    origins = apply_text(config, read_text(*source.file), *source.file);
  }
  std::map<std::string, std::string> overridden;
  for (const std::string& text : source.overrides) {
    overridden[apply_override(config, text)] = text;
  }
  if (source.metadata) {
    config.recording.metadata = source.metadata;
  }

  const auto problem = validate(config);
  if (!problem) {
    return config;
  }
  const std::string found = problem->field + " " + problem->message;
  for (const auto& [name, text] : overridden) {
    origins.erase(name);
    if (name == problem->field || problem->message.find(name) != std::string::npos) {
      throw UsageError("--set " + text + ": " + found + ".");
    }
  }
  const auto* origin = origin_of(*problem, origins);
  if (origin == nullptr) {
    throw std::logic_error("the default configuration is not valid: " + found);
  }
  throw InputError(*source.file, Place::named(place(origin->second)), found,
                   "`adit config` prints every setting with its unit and default");
}

std::string to_toml(const Config& config) {
  // nlohmann::json prints the shortest text that reads back as the same number, and 1.0 for a whole
  // double.
  std::ostringstream text;
  text << "# The effective configuration of adit: every setting, with its unit, meaning and "
          "default.\n";
  const auto defaults = to_json(Config{});
  Config::visit(config, [&](const std::string& section, const auto& fields) {
    text << "\n[" << section << "]\n";
    std::decay_t<decltype(fields)>::visit(
        fields, [&](const std::string& name, const auto& value, const std::string& unit,
                    const std::string& help) {
          const nlohmann::ordered_json& standard = defaults[section][name];
          const nlohmann::ordered_json given = json_of(value);
          text << "# " << (unit.empty() ? "" : "[" + unit + "] ") << help << "; default "
               << (standard.is_null() ? "not given" : standard.dump()) << "\n"
               << (given.is_null() ? "# " + name + " = (not given)" : name + " = " + given.dump())
               << "\n";
        });
  });
  return text.str();
}

nlohmann::ordered_json to_json(const Config& config) {
  nlohmann::ordered_json object;
  Config::visit(config, [&](const std::string& section, const auto& fields) {
    std::decay_t<decltype(fields)>::visit(
        fields, [&](const std::string& name, const auto& value, auto&&...) {
          object[section][name] = json_of(value);
        });
  });
  return object;
}

}  // namespace adit
