// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/pose_table.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/table_cells.hpp"

namespace adit {
namespace {

struct Columns {
  std::array<std::size_t, 8> at{};  ///< as in pose_columns()
  bool nanoseconds = false;         ///< the time's name says so
  std::size_t count = 0;
  char separator = ',';
};

Columns find_columns(const std::filesystem::path& file, uint64_t line, std::string_view header) {
  const char separator = separator_of(header);
  const std::vector<std::string_view> names = cells_of(header, separator);
  Columns columns{.count = names.size(), .separator = separator};
  for (std::size_t i = 0; i < columns.at.size(); ++i) {
    const TableColumn& wanted = pose_columns()[i];
    columns.at[i] = find_column(names, wanted);
    if (columns.at[i] == names.size()) {
      throw InputError(file, Place::line(line),
                       "no column is " + std::string(wanted.what) +
                           ": a table of poses has a time, x, y, z, qx, qy, qz and qw",
                       "Name the columns so in its first line");
    }
  }
  const std::string_view time = names[columns.at[0]];
  columns.nanoseconds = column_unit(time) == "ns" || time.ends_with("_ns");
  return columns;
}

/// EuRoC writes nanoseconds, with and without saying so.
std::optional<Nanoseconds> stamp_of(std::string_view cell, bool nanoseconds) {
  constexpr uint64_t kNoSeconds = 100'000'000'000'000;  // three million years
  const std::optional<uint64_t> whole = parse_unsigned(cell);
  if (whole && (nanoseconds || *whole > kNoSeconds) &&
      *whole <= static_cast<uint64_t>(Nanoseconds::max().count())) {
    return Nanoseconds(static_cast<int64_t>(*whole));
  }
  return nanoseconds ? std::nullopt : parse_seconds(cell);
}

/// The pose of a line; nothing where it has no numbers: a sweep that has no pose.
std::optional<StampedPose> pose_of(const std::filesystem::path& file, uint64_t line,
                                   const std::vector<std::string_view>& cells,
                                   const Columns& columns) {
  const std::optional<Nanoseconds> stamp = stamp_of(cells[columns.at[0]], columns.nanoseconds);
  if (!stamp) {
    throw InputError(file, Place::line(line), in_quotes(cells[columns.at[0]]) + " is no time",
                     "Correct or delete the line");
  }
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::string_view cell = cells[columns.at[i + 1]];
    if (cell.empty()) {
      return std::nullopt;
    }
    const std::optional<double> value = parse_double(cell);
    if (!value || !(std::abs(*value) <= 1e12)) {
      throw InputError(file, Place::line(line), in_quotes(cell) + " is not a number up to 1e12",
                       "Correct or delete the line");
    }
    v[i] = *value;
  }
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(q.norm() > 1e-3 && q.norm() < 1e3)) {
    throw InputError(file, Place::line(line), "the quaternion has not the length 1",
                     "Correct or delete the line");
  }
  StampedPose pose{.stamp = *stamp};
  pose.pose.linear() = q.normalized().toRotationMatrix();
  pose.pose.translation() << v[0], v[1], v[2];
  return pose;
}

}  // namespace

bool is_table(std::string_view text) {
  const std::string_view first = text.substr(0, text.find('\n'));
  const char separator = separator_of(first);
  const std::vector<std::string_view> names = cells_of(first, separator);
  return separator != ' ' && names.size() >= pose_columns().size() &&
         std::ranges::all_of(names, [](std::string_view name) {
           return !name.empty() && std::isalpha(static_cast<unsigned char>(name.front())) != 0;
         });
}

Trajectory read_pose_table(const std::filesystem::path& file, std::string_view text) {
  Trajectory trajectory{.file = file, .stamped = true, .poses = {}};
  LineReader lines(text);
  const Columns columns = find_columns(file, 1, lines.next().value_or(""));
  while (const std::optional<std::string_view> line = lines.next()) {
    const std::vector<std::string_view> cells = cells_of(*line, columns.separator);
    if (trimmed_cell(*line).empty()) {
      continue;
    }
    if (cells.size() != columns.count) {
      throw InputError(file, Place::line(lines.number()),
                       "cells found: " + std::to_string(cells.size()) + ", expected " +
                           std::to_string(columns.count) + " as in the first line",
                       "Correct or delete the line");
    }
    if (const auto pose = pose_of(file, lines.number(), cells, columns)) {
      trajectory.poses.push_back(*pose);
    }
  }
  return trajectory;
}

}  // namespace adit
