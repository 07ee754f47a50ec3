// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/loop_table.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

constexpr const char* kWriteAnew = "Name the truth.loops.csv that `adit simulate` writes";
constexpr const char* kWriteMeasured = "A closure has its two times and T_a_b as x y z qx qy qz qw";
constexpr double kUnit = 1e-3;  // that a quaternion's length may differ from 1 by

/// The cells of a line; of Windows' line ends nothing is left.
std::vector<std::string> table_cells(std::string line) {
  while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) {
    line.pop_back();
  }
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    cells.push_back(cell);
  }
  return cells;
}

double number_of(const std::string& cell, const std::filesystem::path& file, uint64_t line,
                 const char* remedy) {
  std::size_t used = 0;
  double value = std::nan("");
  try {
    value = std::stod(cell, &used);
  } catch (const std::exception&) {
    used = std::string::npos;
  }
  if (used != cell.size() || !std::isfinite(value)) {
    throw InputError(file, Place::line(line), "'" + cell + "' is no number", remedy);
  }
  return value;
}

/// A line of a table: its number, and what it has in the columns that were asked for.
template <std::size_t N>
struct Line {
  uint64_t number = 0;
  std::array<double, N> values{};
};

template <std::size_t N>
std::vector<Line<N>> read_lines(const std::filesystem::path& file,
                                const std::array<const char*, N>& names, const char* remedy) {
  std::ifstream in = open_text_file(file);
  std::string line;
  if (!std::getline(in, line)) {
    throw InputError(file, {}, "it cannot be read, or is empty", remedy);
  }
  const std::vector<std::string> head = table_cells(line);
  std::array<std::size_t, N> wanted{};
  for (std::size_t i = 0; i < N; ++i) {
    const auto found = std::ranges::find(head, names[i]);
    if (found == head.end()) {
      throw InputError(file, Place::line(1), std::string("there is no column ") + names[i], remedy);
    }
    wanted[i] = static_cast<std::size_t>(found - head.begin());
  }
  std::vector<Line<N>> lines;
  for (uint64_t number = 2; std::getline(in, line); ++number) {
    const std::vector<std::string> cells = table_cells(line);
    if (cells.empty()) {
      continue;
    }
    if (cells.size() < head.size()) {
      throw InputError(file, Place::line(number), "the line ends early", remedy);
    }
    Line<N>& read = lines.emplace_back(Line<N>{.number = number});
    for (std::size_t i = 0; i < N; ++i) {
      read.values[i] = number_of(cells[wanted[i]], file, number, remedy);
    }
    if (read.values[1] <= read.values[0]) {  // times come first
      throw InputError(file, Place::line(number), "the second moment is not later than the first",
                       remedy);
    }
  }
  return lines;
}

}  // namespace

std::vector<TrueLoop> read_true_loops(const std::filesystem::path& file) {
  constexpr std::array kNames = {"time_a_s", "time_b_s", "distance_m", "overlap"};
  std::vector<TrueLoop> loops;
  for (const auto& [number, values] : read_lines(file, kNames, kWriteAnew)) {
    loops.push_back({.earlier = nanoseconds(values[0]),
                     .later = nanoseconds(values[1]),
                     .distance = values[2],
                     .overlap = values[3]});
  }
  return loops;
}

std::vector<MeasuredLoop> read_measured_loops(const std::filesystem::path& file) {
  constexpr std::array kNames = {"time_a_s", "time_b_s", "x", "y", "z", "qx", "qy", "qz", "qw"};
  std::vector<MeasuredLoop> loops;
  for (const auto& [number, values] : read_lines(file, kNames, kWriteMeasured)) {
    const Eigen::Quaterniond q(values[8], values[5], values[6], values[7]);
    if (std::abs(q.norm() - 1.0) > kUnit) {
      throw InputError(file, Place::line(number), "its quaternion is not of length 1",
                       kWriteMeasured);
    }
    MeasuredLoop& loop = loops.emplace_back(
        MeasuredLoop{.earlier = nanoseconds(values[0]), .later = nanoseconds(values[1])});
    loop.T_earlier_later.linear() = q.normalized().toRotationMatrix();
    loop.T_earlier_later.translation() = Eigen::Vector3d(values[2], values[3], values[4]);
  }
  return loops;
}

}  // namespace adit
