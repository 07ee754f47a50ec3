// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/table_shapes.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "adit/tools/map_database/row_checksums.hpp"

namespace adit {
namespace {

bool is_blob_of(const SqliteValue& value, std::size_t doubles) {
  const auto* blob = std::get_if<std::vector<std::byte>>(&value);
  return blob != nullptr && blob->size() == doubles * sizeof(double);
}

RowValue view_of(const SqliteValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    return std::string_view(*text);
  }
  if (const auto* blob = std::get_if<std::vector<std::byte>>(&value)) {
    return std::span<const std::byte>(*blob);
  }
  if (const auto* real = std::get_if<double>(&value)) {
    return *real;
  }
  const auto* integer = std::get_if<int64_t>(&value);
  return integer != nullptr ? RowValue(*integer) : RowValue();
}

}  // namespace

bool fits(const SqliteValue& value, char letter) {
  switch (letter) {
    case 'n':
      return std::holds_alternative<std::monostate>(value);
    case 'i':
      return std::holds_alternative<int64_t>(value);
    case 'r':
      return std::holds_alternative<int64_t>(value) || std::holds_alternative<double>(value);
    case 't':
      return std::holds_alternative<std::string>(value);
    case 'b':
      return std::holds_alternative<std::vector<std::byte>>(value);
    case 'p':
      return is_blob_of(value, 12);
    case 'm':
      return is_blob_of(value, 36);
    case 's':
      return is_blob_of(value, 9);
    case 'v':
      return is_blob_of(value, 3);
    case 'x':
      return is_blob_of(value, 6);
    case 'c':
      return is_blob_of(value, 1);
    default:
      return true;
  }
}

bool fits(const SqliteRow& row, const Shape& shape) {
  if (row.values.size() < shape.least || row.values.size() > shape.columns.size()) {
    return false;
  }
  for (std::size_t i = 0; i < row.values.size(); ++i) {
    if (!fits(row.values[i], shape.columns[i])) {
      return false;
    }
  }
  return true;
}

bool is_as_written(const SqliteRow& row, const Shape& shape) {
  if (row.values.size() < shape.columns.size() || shape.columns.back() != 'c') {
    return true;
  }
  std::vector<RowValue> values;
  for (std::size_t i = 0; i + 1 < row.values.size(); ++i) {
    values.push_back(shape.columns[i] == 'n' ? RowValue(row.rowid) : view_of(row.values[i]));
  }
  const auto& stored = std::get<std::vector<std::byte>>(row.values.back());
  return std::ranges::equal(stored, row_checksum(values));
}

}  // namespace adit
