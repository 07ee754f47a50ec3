// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Trajectories as text, in the two formats the field's tools share:
//   TUM    "t tx ty tz qx qy qz qw", seconds and metres, one pose a line;
//   KITTI  the 12 numbers of the upper 3x4 of the pose, row by row, one pose a line, no times.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

/// How columns name the parts of a tangent vector [rho, phi, v] (m, rad, m/s).
inline constexpr std::array<std::string_view, 9> kTangentNames = {"x",  "y",  "z",  "rx", "ry",
                                                                  "rz", "vx", "vy", "vz"};

/// A file of text: TUM's eight columns or KITTI's twelve.
enum class TrajectoryFormat { tum, kitti };
/// The format's name.
std::string_view to_string(TrajectoryFormat format);

/// A trajectory as it was read. Where `stamped` is false the poses are numbered and their stamps
/// are 0.
struct Trajectory {
  std::filesystem::path file;                       ///< it was read from
  TrajectoryFormat format = TrajectoryFormat::tum;  ///< that the file has
  bool stamped = false;                             ///< poses have times
  std::vector<StampedPose> poses;                   ///< in the order of the file
  /// Where its parts begin, but for the first: the odometry started anew there, and nothing ties
  /// one part to the next.
  std::vector<std::size_t> parts{};
};

/// One of the parts alone, counted from 1.
Trajectory part_of(const Trajectory& trajectory, std::size_t number);

/// Reads either format, told apart by 8 or 12 columns; '#' starts a comment, of which one that
/// a TrajectoryWriter has written begins a part, and one before the poses that names all eight
/// columns tells their order; blank lines are skipped. Quaternions are
/// normalised, rotation matrices brought back to the nearest rotation. `times` (one number in
/// seconds a line) stamps a KITTI trajectory. Throws InputError with the line: not numbers, not
/// finite, a mixture of formats, no rotation, times that go backwards, no pose at all.
Trajectory read_trajectory(const std::filesystem::path& file,
                           const std::optional<std::filesystem::path>& times = std::nullopt);

/// Writes poses as they come. Numbers are the shortest text that reads back to the same double;
/// stamps have nine decimals; quaternions have qw >= 0. Throws OutputError.
class TrajectoryWriter {
 public:
  /// Makes the file.
  TrajectoryWriter(std::filesystem::path path, TrajectoryFormat format);

  /// Appends a pose.
  void write(const StampedPose& pose);
  /// Nothing ties what follows to what came before: a comment says so, in TUM's format, which has
  /// such.
  void begin_part();
  /// Hands everything to the operating system.
  void flush() { file_.flush(); }
  void close() {
    file_.close();
  }  ///< must be called for the file to be whole; the destructor cannot report

 private:
  OutputFile file_;
  TrajectoryFormat format_;
};

/// Writes a whole trajectory; parts begin at these poses. Throws OutputError.
void write_trajectory(const std::filesystem::path& path, TrajectoryFormat format,
                      std::span<const StampedPose> poses, std::span<const std::size_t> parts = {});

}  // namespace adit
