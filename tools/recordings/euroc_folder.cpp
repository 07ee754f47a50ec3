// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/euroc_folder.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "adit/slam/core/units.hpp"
#include "adit/tools/recordings/series_recording.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/table_cells.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

// Numbers that are read of a line besides its time, at most: those of a pose.
constexpr std::size_t kNumbers = 7;

/// Columns of a kind of series, the time first, in the order of EuRoC's own files.
using WantedColumns = std::vector<TableColumn>;

/// The columns of a table of IMU samples: rates (rad/s), then accelerations (m/s²).
const WantedColumns& imu_columns() {
  static const WantedColumns kColumns = {
      pose_columns()[0],
      {"the rate about x", {"wrssx", "wx", "gyrox", "gyrx", "gx", "omegax", "angularvelocityx"}},
      {"the rate about y", {"wrssy", "wy", "gyroy", "gyry", "gy", "omegay", "angularvelocityy"}},
      {"the rate about z", {"wrssz", "wz", "gyroz", "gyrz", "gz", "omegaz", "angularvelocityz"}},
      {"the acceleration along x",
       {"arssx", "ax", "accx", "accelx", "accelerationx", "linearaccelerationx"}},
      {"the acceleration along y",
       {"arssy", "ay", "accy", "accely", "accelerationy", "linearaccelerationy"}},
      {"the acceleration along z",
       {"arssz", "az", "accz", "accelz", "accelerationz", "linearaccelerationz"}}};
  return kColumns;
}

/// The columns of a table of poses: position (m), then the quaternion, w first.
const WantedColumns& truth_columns() {
  const auto& c = pose_columns();
  static const WantedColumns kColumns = {c[0], c[1], c[2], c[3], c[7], c[4], c[5], c[6]};
  return kColumns;
}

/// Where a line has its time and its numbers.
struct Layout {
  char separator = ',';
  std::size_t time = 0;
  double time_unit = 0.0;  ///< ns; 0: whole numbers are nanoseconds, others seconds
  std::vector<std::size_t> at{1, 2, 3, 4, 5, 6, 7};
  std::vector<double> scale = std::vector<double>(kNumbers, 1.0);  ///< to SI units
  uint64_t header = 0;                                             ///< lines
};

/// What a unit is worth in SI units. Blanks, '^' and '*' do not count: "m s^-2" is "ms-2".
struct Unit {
  std::string_view name;
  double worth;
};
constexpr Unit kTimeUnits[] = {{"ns", 1.0}, {"us", 1e3}, {"µs", 1e3}, {"μs", 1e3},
                               {"ms", 1e6}, {"s", 1e9},  {"sec", 1e9}};
constexpr Unit kLengths[] = {{"", 1.0}, {"m", 1.0}, {"mm", 1e-3}, {"cm", 1e-2}, {"1", 1.0}};
constexpr Unit kRates[] = {{"", 1.0},        {"rads-1", 1.0},     {"rad/s", 1.0},
                           {"rad/sec", 1.0}, {"degs-1", kDegree}, {"deg/s", kDegree},
                           {"°/s", kDegree}, {"°s-1", kDegree},   {"deg/sec", kDegree},
                           {"dps", kDegree}};
constexpr Unit kAccelerations[] = {
    {"", 1.0},      {"ms-2", 1.0},   {"m/s2", 1.0},           {"m/s²", 1.0},
    {"m/s/s", 1.0}, {"m/sec2", 1.0}, {"g", kStandardGravity}, {"mg", 1e-3 * kStandardGravity}};

std::optional<double> find_worth(std::string_view unit, std::span<const Unit> units) {
  std::string plain;
  for (const char c : unit) {
    plain += c == ' ' || c == '^' || c == '*' ? "" : std::string(1, c);
  }
  const auto found = std::ranges::find(units, plain, &Unit::name);
  return found == units.end() ? std::nullopt : std::optional(found->worth);
}

double worth_of(std::string_view name, std::span<const Unit> units, const fs::path& file,
                uint64_t line) {
  if (const std::optional<double> worth = find_worth(column_unit(name), units)) {
    return *worth;
  }
  throw InputError(file, Place::line(line), "the unit of column " + in_quotes(name) + " is unknown",
                   "Write the column in SI units and name it so, such as [m s^-2] or [rad s^-1]");
}

/// Lines before the first that begins with a number.
struct Head {
  std::vector<std::string> lines;
  std::string first;  ///< line with numbers; empty where there is none
};

bool begins_with_number(const std::string& line) {
  const std::vector<std::string_view> cells = cells_of(line, separator_of(line));
  return !line.starts_with('#') && !cells.empty() && parse_double(cells.front()).has_value();
}

/// A line of names that is no comment.
bool is_bare_head(const std::string& line, const std::vector<std::string_view>& names) {
  return !line.starts_with('#') && !names.empty() &&
         std::ranges::all_of(names, [](std::string_view name) {
           return !name.empty() && (name.front() == '"' ||
                                    std::isalpha(static_cast<unsigned char>(name.front())) != 0);
         });
}

/// ns; "[us]" behind the name, or "_us" at its end. 0 where the name does not tell.
double time_unit_of(std::string_view name, const fs::path& file, uint64_t line) {
  if (!column_unit(name).empty()) {
    return worth_of(name, kTimeUnits, file, line);
  }
  const std::size_t last = name.rfind('_');
  return last == name.npos ? 0.0 : find_worth(name.substr(last + 1), kTimeUnits).value_or(0.0);
}

Head read_head(const fs::path& file) {
  constexpr std::size_t kMost = 64;  // lines; who writes more above the numbers writes no table
  Head head;
  std::ifstream stream = open_text_file(file);
  for (std::string line; head.lines.size() < kMost && std::getline(stream, line);) {
    if (begins_with_number(line)) {
      head.first = line;
      break;
    }
    head.lines.push_back(line);
  }
  return head;
}

/// By the line of names. One that names fewer than two of the columns is a comment: then the layout
/// is EuRoC's own. Throws InputError where some of the columns have no name, or a unit is unknown.
Layout find_layout(const fs::path& file, const WantedColumns& wanted) {
  const Head head = read_head(file);
  Layout layout{.separator = separator_of(head.first.empty() ? "," : head.first)};
  for (std::size_t i = 0; i < head.lines.size(); ++i) {
    const std::vector<std::string_view> names =
        cells_of(head.lines[i], separator_of(head.lines[i]));
    if (is_bare_head(head.lines[i], names)) {
      layout.header = i + 1;
    }
    std::vector<std::size_t> at;
    std::string missing;
    for (const TableColumn& column : wanted) {
      at.push_back(find_column(names, column));
      if (at.back() == names.size()) {
        missing += (missing.empty() ? "" : ", ") + std::string(column.what);
      }
    }
    const auto found = std::ranges::count_if(
        std::span(at).subspan(1), [&](std::size_t place) { return place < names.size(); });
    if (found < 2 || names.back().starts_with("...")) {
      continue;
    }
    if (!missing.empty()) {
      throw InputError(file, Place::line(i + 1), "it names some columns, and none for " + missing,
                       "Name all columns as EuRoC does, or leave the line of names out");
    }
    layout.time = at.front();
    layout.time_unit = time_unit_of(names[at[0]], file, i + 1);
    layout.at.assign(at.begin() + 1, at.end());
    for (std::size_t k = 0; k + 1 < at.size(); ++k) {
      const bool pose = wanted.size() > kNumbers;
      const std::span<const Unit> units = pose    ? std::span<const Unit>(kLengths)
                                          : k < 3 ? std::span<const Unit>(kRates)
                                                  : std::span<const Unit>(kAccelerations);
      layout.scale[k] = worth_of(names[at[k + 1]], units, file, i + 1);
    }
  }
  return layout;
}

Nanoseconds time_of(std::string_view word, const Layout& layout) {
  const std::optional<uint64_t> whole = parse_unsigned(word);
  const bool exact = layout.time_unit == 1.0 || layout.time_unit == 0.0;
  if (whole && exact && *whole <= static_cast<uint64_t>(Nanoseconds::max().count())) {
    return Nanoseconds(static_cast<int64_t>(*whole));
  }
  std::optional<Nanoseconds> time;
  if (layout.time_unit == 1e9 || (layout.time_unit == 0.0 && word.find('.') != word.npos)) {
    time = parse_seconds(word);
  } else if (const std::optional<double> value = parse_double(word); value && !exact) {
    time = to_nanoseconds(*value * layout.time_unit * 1e-9);
  }
  if (!time) {
    throw SeriesLineError(in_quotes(word) + " is no time in " +
                          (exact ? "nanoseconds" : "the unit that the table names"));
  }
  return *time;
}

/// The time of a line and its first `needed` numbers.
struct Line {
  Nanoseconds stamp{0};
  std::array<double, kNumbers> v{};
};

Line parse(std::string_view text, const Layout& layout, std::size_t needed) {
  const std::vector<std::string_view> cells = cells_of(text, layout.separator);
  Line line{.stamp = time_of(layout.time < cells.size() ? cells[layout.time] : "", layout)};
  for (std::size_t i = 0; i < needed; ++i) {
    const std::size_t at = layout.at[i];
    if (at >= cells.size()) {
      throw SeriesLineError("it has " + std::to_string(cells.size() - 1) +
                            " numbers behind the time, expected " + std::to_string(needed));
    }
    const std::optional<double> value = parse_double(cells[at]);
    if (!value) {
      throw SeriesLineError(in_quotes(cells[at]) + " is no number");
    }
    line.v[i] = layout.scale[i] * *value;
  }
  return line;
}

EventValue imu_sample(std::string_view text, const Layout& layout) {
  const auto [stamp, v] = parse(text, layout, 6);
  return ImuSample{stamp, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

EventValue pose(std::string_view text, const Layout& layout) {
  const auto [stamp, v] = parse(text, layout, 7);
  ReferencePose pose{.stamp = stamp, .parent = "world", .child = "body"};
  pose.T_parent_child = series_pose({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]});
  return pose;
}

/// The series of a table whose first lines may name its columns.
EventSeries table_series(const std::string& name, TopicKind kind, const fs::path& file) {
  const bool imu = kind == TopicKind::imu;
  const Layout layout = find_layout(file, imu ? imu_columns() : truth_columns());
  const ReadLine read = [imu, layout](std::string_view text) {
    return imu ? imu_sample(text, layout) : pose(text, layout);
  };
  return text_series({"/" + name, "EuRoC CSV", kind, {}}, file, read, layout.header);
}

TopicKind kind_of(const std::string& folder) {
  if (folder.starts_with("imu")) {
    return TopicKind::imu;
  }
  for (const char* poses : {"state_groundtruth_estimate", "vicon", "mocap"}) {
    if (folder.starts_with(poses)) {
      return TopicKind::poses;
    }
  }
  return TopicKind::other;
}

/// Either is enough to recognise the folder by.
constexpr std::array kMarks{"imu0", "state_groundtruth_estimate0"};

fs::path base_of(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "mav0", ignored) ? folder / "mav0" : folder;
}

}  // namespace

bool is_euroc_folder(const fs::path& folder) {
  return std::ranges::any_of(kMarks, [&](const char* mark) {
    std::error_code ignored;
    return fs::is_regular_file(base_of(folder) / mark / "data.csv", ignored);
  });
}

std::unique_ptr<Recording> open_euroc_folder(const fs::path& folder) {
  std::vector<EventSeries> series;
  std::error_code error;
  for (fs::directory_iterator entry(base_of(folder), error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const TopicKind kind = kind_of(name);
    const fs::path file = entry->path() / "data.csv";
    std::error_code ignored;
    if (kind != TopicKind::other && fs::is_regular_file(file, ignored)) {
      series.push_back(table_series(name, kind, file));
    }
  }
  if (error) {
    throw InputError(folder, {}, "cannot be looked into: " + error.message(),
                     "Check the permissions");
  }
  std::ranges::sort(series, {}, [](const EventSeries& one) { return one.topic.name; });
  const std::string count = std::to_string(series.size());
  return make_series_recording(folder.string() + ": EuRoC folder, " + count + " series",
                               std::move(series));
}

}  // namespace adit
