// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/trajectory_io.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/clouds/sweep_times.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/table_cells.hpp"

namespace adit {
namespace {

constexpr std::string_view kPart = "# part: ";  // begins a line between two parts
constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kKittiColumns = 12;

using Words = std::array<std::string_view, kKittiColumns>;
using Numbers = std::array<double, kKittiColumns>;

constexpr double kLargestNumber = 1e12;  // m, beyond any position; s, beyond any time

/// The line's numbers. Throws InputError for what is none, not finite or absurd.
Numbers parse_numbers(const std::filesystem::path& file, uint64_t line,
                      std::span<const std::string_view> words) {
  Numbers numbers{};
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::optional<double> number = parse_double(words[i]);
    if (!number || !(std::abs(*number) <= kLargestNumber)) {
      throw InputError(file, Place::line(line),
                       "column " + std::to_string(i + 1) + " is " + in_quotes(words[i]) +
                           ", not a number up to 1e12",
                       "Correct or delete the line");
    }
    numbers[i] = *number;
  }
  return numbers;
}

/// Where a line of eight columns has its time, x, y, z, qx, qy, qz and qw.
using TumOrder = std::array<std::size_t, kTumColumns>;

/// By a comment that names all eight columns.
std::optional<TumOrder> named_order(std::string_view line) {
  const std::vector<std::string_view> names = cells_of(line, separator_of(line));
  TumOrder order{};
  for (std::size_t i = 0; i < order.size(); ++i) {
    order[i] = find_column(names, pose_columns()[i]);
    if (names.size() != order.size() || order[i] == names.size()) {
      return std::nullopt;
    }
  }
  return order;
}

StampedPose tum_pose(const std::filesystem::path& file, uint64_t line,
                     std::span<const std::string_view> written, const TumOrder& order) {
  std::array<std::string_view, kTumColumns> words;
  for (std::size_t i = 0; i < words.size(); ++i) {
    words[i] = written[order[i]];
  }
  const std::optional<Nanoseconds> stamp = parse_seconds(words[0]);
  if (!stamp) {
    throw InputError(file, Place::line(line),
                     "the time " + in_quotes(words[0]) + " is no number of seconds up to 292 years",
                     "Correct the line; nanoseconds need dividing by 1e9");
  }
  const Numbers n = parse_numbers(file, line, words);
  const Eigen::Quaterniond q(n[7], n[4], n[5], n[6]);
  const double norm = q.norm();
  if (!(norm > 1e-3 && norm < 1e3)) {
    throw InputError(file, Place::line(line),
                     "the quaternion (columns 5 to 8, qx qy qz qw) has length " +
                         std::to_string(norm) + ", not 1",
                     "Correct or delete the line");
  }
  StampedPose pose;
  pose.stamp = *stamp;
  pose.pose.linear() = q.normalized().toRotationMatrix();
  pose.pose.translation() = Eigen::Vector3d(n[1], n[2], n[3]);
  return pose;
}

StampedPose kitti_pose(const std::filesystem::path& file, uint64_t line,
                       std::span<const std::string_view> words) {
  const Numbers n = parse_numbers(file, line, words);
  StampedPose pose;
  pose.pose.linear() << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
  pose.pose.translation() = Eigen::Vector3d(n[3], n[7], n[11]);
  // Published files are rounded to six digits or fewer; what is farther off is no rotation at all.
  const Eigen::Isometry3d nearest = orthonormalized(pose.pose);
  const double deviation = (nearest.linear() - pose.pose.linear()).cwiseAbs().maxCoeff();
  if (!(deviation < 0.01)) {
    throw InputError(
        file, Place::line(line),
        "columns 1-3, 5-7 and 9-11 are no rotation matrix: the nearest one differs by " +
            std::to_string(deviation),
        "A KITTI line holds r11 r12 r13 tx r21 r22 r23 ty r31 r32 r33 tz");
  }
  pose.pose = nearest;
  return pose;
}

[[noreturn]] void fail_columns(const std::filesystem::path& file, uint64_t line,
                               std::size_t columns, std::size_t expected) {
  const std::string wanted = expected == 0
                                 ? "8 (TUM: t tx ty tz qx qy qz qw) or 12 (KITTI: the 3x4 pose)"
                                 : std::to_string(expected) + " as in the lines before";
  throw InputError(file, Place::line(line),
                   "columns found: " + std::to_string(columns) + ", expected " + wanted,
                   "Correct or delete the line");
}

}  // namespace

std::string_view to_string(TrajectoryFormat format) {
  return format == TrajectoryFormat::tum ? "TUM" : "KITTI";
}

Trajectory read_trajectory(const std::filesystem::path& file,
                           const std::optional<std::filesystem::path>& times) {
  const std::string text = read_text_file(file);
  Trajectory trajectory;
  trajectory.file = file;
  std::size_t columns = 0;
  TumOrder order{0, 1, 2, 3, 4, 5, 6, 7};
  LineReader lines(text);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->starts_with('#') && trajectory.poses.empty()) {
      order = named_order(*line).value_or(order);
    }
    if (line->starts_with(kPart) && !trajectory.poses.empty()) {
      trajectory.parts.push_back(trajectory.poses.size());
    }
    Words words;
    const std::size_t count = split_words(without_comment(*line), words);
    if (count == 0) {
      continue;
    }
    const bool known = count == kTumColumns || count == kKittiColumns;
    if (!known || (columns != 0 && count != columns)) {
      fail_columns(file, lines.number(), count, columns);
    }
    columns = count;
    const std::span<const std::string_view> used = std::span(words).first(count);
    const StampedPose pose = count == kTumColumns ? tum_pose(file, lines.number(), used, order)
                                                  : kitti_pose(file, lines.number(), used);
    if (!trajectory.poses.empty() && pose.stamp < trajectory.poses.back().stamp) {
      throw InputError(file, Place::line(lines.number()),
                       "time goes backwards, to " + std::string(words[0]) + " s",
                       "Sort the file by time");
    }
    trajectory.poses.push_back(pose);
  }
  if (!trajectory.parts.empty() && trajectory.parts.back() == trajectory.poses.size()) {
    trajectory.parts.pop_back();  // the run ended before it had a pose
  }
  if (trajectory.poses.empty()) {
    throw InputError(file, {}, "it holds no pose",
                     "Expected TUM (8 columns) or KITTI (12 columns) lines");
  }
  trajectory.format = columns == kTumColumns ? TrajectoryFormat::tum : TrajectoryFormat::kitti;
  trajectory.stamped = trajectory.format == TrajectoryFormat::tum;
  if (times && !trajectory.stamped) {
    const std::vector<Nanoseconds> stamps = read_times(*times);
    require_matching_times(*times, stamps.size(), trajectory.poses.size(),
                           "poses in " + file.string());
    for (std::size_t i = 0; i < stamps.size(); ++i) {
      trajectory.poses[i].stamp = stamps[i];
    }
    trajectory.stamped = true;
  }
  return trajectory;
}

Trajectory part_of(const Trajectory& trajectory, std::size_t number) {
  Trajectory part = trajectory;
  const std::size_t begin = number > 1 ? trajectory.parts.at(number - 2) : 0;
  const std::size_t end =
      number <= trajectory.parts.size() ? trajectory.parts[number - 1] : trajectory.poses.size();
  const auto at = [&](std::size_t i) {
    return trajectory.poses.begin() + static_cast<std::ptrdiff_t>(i);
  };
  part.poses.assign(at(begin), at(end));
  part.parts.clear();
  return part;
}

TrajectoryWriter::TrajectoryWriter(std::filesystem::path path, TrajectoryFormat format)
    : file_(std::move(path)), format_(format) {}

void TrajectoryWriter::write(const StampedPose& pose) {
  std::string line;
  if (format_ == TrajectoryFormat::tum) {
    append_stamp(line, pose.stamp);
    Eigen::Quaterniond q(pose.pose.linear());
    q.normalize();
    if (q.w() < 0.0) {
      q.coeffs() = -q.coeffs();
    }
    const Eigen::Vector3d t = pose.pose.translation();
    for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
      line += ' ';
      append_number(line, value);
    }
  } else {
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 4; ++column) {
        line += row + column == 0 ? "" : " ";
        append_number(line, pose.pose.matrix()(row, column));
      }
    }
  }
  line += '\n';
  file_.write(line);
}

void TrajectoryWriter::begin_part() {
  if (format_ == TrajectoryFormat::tum) {
    file_.write(std::string(kPart) +
                "the odometry started anew; nothing ties what follows to what comes before\n");
  }
}

void write_trajectory(const std::filesystem::path& path, TrajectoryFormat format,
                      std::span<const StampedPose> poses, std::span<const std::size_t> parts) {
  TrajectoryWriter writer(path, format);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (std::ranges::binary_search(parts, i)) {
      writer.begin_part();
    }
    writer.write(poses[i]);
  }
  writer.close();
}

}  // namespace adit
