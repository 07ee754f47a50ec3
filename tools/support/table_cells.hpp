// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace adit {

/// Without blanks, a line end of Windows and '#' around it.
std::string_view trimmed_cell(std::string_view text);

/// What separates the cells of a line: a comma, a semicolon, a tab, or else ' ' for blanks. The
/// most frequent of the three wins.
char separator_of(std::string_view line);

/// The cells of a line, trimmed. Several blanks in a row separate once.
std::vector<std::string_view> cells_of(std::string_view line, char separator = ',');

/// A column of a table and the names that programs give it, as plain_column_name() makes them.
struct TableColumn {
  std::string_view what;  ///< for people
  std::vector<std::string_view> names;
};

/// A column's name for comparisons: lower case, letters and digits alone, without the unit behind
/// it in brackets. "w_RS_S_x [rad s^-1]" is "wrssx".
std::string plain_column_name(std::string_view name);

/// The unit that stands behind a name in square or round brackets; empty where there is none.
std::string_view column_unit(std::string_view name);

/// Where the first column stands that is called so; the number of names where there is none.
std::size_t find_column(const std::vector<std::string_view>& names, const TableColumn& wanted);

/// The columns of a table of poses: a time, x, y, z, qx, qy, qz, qw, as adit, its simulator, EuRoC
/// and common exporters name them.
const std::array<TableColumn, 8>& pose_columns();

}  // namespace adit
