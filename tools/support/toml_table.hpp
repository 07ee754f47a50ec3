// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/support/toml.hpp"

namespace adit {

/// A TOML file that holds a user's list of things. Each refusal (InputError) names the line and the
/// remedy.
class TomlFile {
 public:
  /// Throws InputError: it cannot be read, or is no TOML.
  TomlFile(std::string_view text, std::filesystem::path file, std::string remedy);

  const toml::table& root() const { return root_; }
  [[noreturn]] void refuse(const toml::node& node, const std::string& found) const;

 private:
  std::filesystem::path file_;
  std::string remedy_;
  toml::table root_;
};

/// A table of such a file, which must outlive it.
class TomlTable {
 public:
  explicit TomlTable(const TomlFile& file) : TomlTable(file, file.root()) {}
  TomlTable(const TomlFile& file, const toml::table& table) : file_(&file), table_(&table) {}

  bool has(std::string_view key) const { return table_->contains(key); }
  /// Refuses other keys. `what`: the table for people, "a fleet".
  void require_only(std::span<const std::string_view> keys, std::string_view what) const;

  // Nothing where there is no such key; refuse another type of value.
  std::optional<std::string> text(std::string_view key) const;
  std::optional<bool> truth(std::string_view key) const;
  std::optional<int64_t> number(std::string_view key) const;
  /// With or without a fraction.
  std::optional<double> real(std::string_view key) const;
  /// A list of numbers, or of such lists (the rows of a matrix), one after the other.
  std::vector<double> reals(std::string_view key) const;
  /// One text or a list of texts.
  std::vector<std::string> texts(std::string_view key) const;
  /// A table in it; nothing where there is none.
  std::optional<TomlTable> table(std::string_view key) const;
  /// The tables of [[key]].
  std::vector<TomlTable> tables(std::string_view key) const;

  /// Of the table as a whole.
  [[noreturn]] void refuse(const std::string& found) const { file_->refuse(*table_, found); }
  /// Of a value in it.
  [[noreturn]] void refuse(std::string_view key, const std::string& found) const;

 private:
  template <class T>
  std::optional<T> value(std::string_view key, const char* what) const;

  const TomlFile* file_;
  const toml::table* table_;
};

}  // namespace adit
