// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/toml_table.hpp"

#include <algorithm>
#include <utility>

#include "adit/tools/support/input_error.hpp"

namespace adit {

TomlFile::TomlFile(std::string_view text, std::filesystem::path file, std::string remedy)
    : file_(std::move(file)), remedy_(std::move(remedy)) {
  try {
    root_ = toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw InputError(file_, Place::line(error.source().begin.line),
                     "it is no TOML: " + std::string(error.description()), remedy_);
  }
}

void TomlFile::refuse(const toml::node& node, const std::string& found) const {
  const auto line = node.source().begin.line;
  throw InputError(file_, line > 0 ? Place::line(line) : Place(), found, remedy_);
}

void TomlTable::refuse(std::string_view key, const std::string& found) const {
  file_->refuse(*table_->get(key), found);
}

void TomlTable::require_only(std::span<const std::string_view> keys, std::string_view what) const {
  for (const auto& [key, value] : *table_) {
    if (std::ranges::count(keys, key.str()) == 0) {
      std::string known;
      for (const std::string_view name : keys) {
        known += (known.empty() ? "" : ", ") + std::string(name);
      }
      refuse(key.str(), std::string(what) + " has no " + std::string(key.str()) + ": " + known);
    }
  }
}

template <class T>
std::optional<T> TomlTable::value(std::string_view key, const char* what) const {
  const toml::node* const node = table_->get(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  const std::optional<T> value = node->value_exact<T>();
  if (!value) {
    refuse(key, std::string(key) + " is no " + what);
  }
  return value;
}

std::optional<std::string> TomlTable::text(std::string_view key) const {
  return value<std::string>(key, "text");
}

std::optional<bool> TomlTable::truth(std::string_view key) const {
  return value<bool>(key, "true or false");
}

std::optional<int64_t> TomlTable::number(std::string_view key) const {
  return value<int64_t>(key, "whole number");
}

std::optional<double> TomlTable::real(std::string_view key) const {
  const toml::node* const node = table_->get(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  const std::optional<double> value = node->value<double>();
  if (!value || node->is_boolean()) {
    refuse(key, std::string(key) + " is no number");
  }
  return value;
}

std::vector<double> TomlTable::reals(std::string_view key) const {
  const toml::node* const node = table_->get(key);
  if (node == nullptr) {
    return {};
  }
  if (node->as_array() == nullptr) {
    refuse(key, std::string(key) + " is no list of numbers");
  }
  std::vector<double> all;
  const auto add = [&](const toml::node& one) {
    const std::optional<double> value = one.value<double>();
    if (!value || one.is_boolean()) {
      file_->refuse(one, std::string(key) + " has something that is no number");
    }
    all.push_back(*value);
  };
  for (const toml::node& item : *node->as_array()) {
    if (const toml::array* const row = item.as_array()) {
      std::ranges::for_each(*row, add);
    } else {
      add(item);
    }
  }
  return all;
}

std::vector<std::string> TomlTable::texts(std::string_view key) const {
  const toml::node* const node = table_->get(key);
  if (node == nullptr) {
    return {};
  }
  if (const auto one = node->value_exact<std::string>()) {
    return {*one};
  }
  const toml::array* const list = node->as_array();
  std::vector<std::string> all;
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const auto one = (*list)[i].value_exact<std::string>();
    if (!one) {
      file_->refuse((*list)[i], std::string(key) + " has something that is no text");
    }
    all.push_back(*one);
  }
  if (list == nullptr) {
    refuse(key, std::string(key) + " is no list of texts");
  }
  return all;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) const {
  const toml::node* const node = table_->get(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (node->as_table() == nullptr) {
    refuse(key, std::string(key) + " is no table");
  }
  return TomlTable(*file_, *node->as_table());
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  const toml::node* const node = table_->get(key);
  const toml::array* const list = node == nullptr ? nullptr : node->as_array();
  if (node != nullptr && (list == nullptr || !list->is_array_of_tables())) {
    refuse(key, std::string(key) + " is written [[" + std::string(key) + "]]");
  }
  std::vector<TomlTable> all;
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    all.emplace_back(*file_, *(*list)[i].as_table());
  }
  return all;
}

}  // namespace adit
