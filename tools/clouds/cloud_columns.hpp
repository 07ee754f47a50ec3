// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// From the columns of a point file to a Sweep, the same for every file format.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "adit/slam/core/types.hpp"
#include "adit/tools/clouds/point_times.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

enum class ScalarType { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
std::size_t size_of(ScalarType type);

/// Numbers of one type, `stride` bytes apart. No alignment is needed.
struct Column {
  const std::byte* data = nullptr;  ///< may be null where there are no points
  std::size_t offset = 0;           ///< bytes from `data` to the first number
  std::size_t stride = 0;
  ScalarType type = ScalarType::f32;
  bool swap_bytes = false;              ///< stored in the other byte order than this machine's
  std::optional<ScalarType> written{};  ///< what the file calls it, where its text became `type`
};

/// What a field of a point means, by its name. `nanoseconds` is the part below a second of a
/// time whose whole seconds are `time`. `curvature` is where some drivers for PCL's normals leave
/// the time (ms). `doppler` is the radial speed (m/s, positive: going away).
/// The last four are of colours: a field a channel, or all three in one number, as PCL packs them.
enum class FieldRole {
  x,
  y,
  z,
  intensity,
  ring,
  time,
  nanoseconds,
  curvature,
  doppler,
  red,
  green,
  blue,
  rgb
};
constexpr std::size_t kFieldRoles = 13;

/// How points are to be understood, where their file does not tell.
struct CloudReading {
  std::optional<double> time_unit{};           ///< s, of the times of points; none: inferred
  double longest = kLongestSweep;              ///< s, from the first point to the last
  std::optional<double> coordinate_scale{};    ///< m of a step of the coordinates; none: metres
  std::optional<Eigen::Vector3d> offset{};     ///< Sweep::offset; none: chosen by this cloud
  std::optional<uint32_t> floats_per_point{};  ///< of a .bin file; none: found by its numbers
  bool colors = false;                         ///< CloudFile::colors are wanted
};

/// The meaning of each named field; -1 where no field has it. Names are compared without case and
/// without CloudCompare's "scalar_" prefix; where several fit, the usual name wins ("intensity"
/// before "reflectivity").
struct FieldRoles {
  FieldRoles() { index.fill(-1); }
  std::array<int, kFieldRoles> index{};
  int operator[](FieldRole role) const { return index[static_cast<std::size_t>(role)]; }
};
/// `colors`: also of those of colours.
FieldRoles find_roles(const std::vector<std::string_view>& names, bool colors = false);

/// The columns of a cloud; x, y and z must be there.
struct CloudColumns {
  std::size_t points = 0;
  std::optional<Column> columns[kFieldRoles];
  std::string time_field{};  ///< name of the column of times
  CloudReading reading{};
  std::optional<Column>& operator[](FieldRole role) {
    return columns[static_cast<std::size_t>(role)];
  }
  const std::optional<Column>& operator[](FieldRole role) const {
    return columns[static_cast<std::size_t>(role)];
  }
};

/// A cloud as a file tells it.
struct CloudFile {
  Sweep sweep;  ///< stamp: see absolute_stamp
  bool absolute_stamp =
      false;  ///< true: the points carry absolute times and sweep.stamp is the earliest of them;
              ///< false: sweep.stamp is the sweep's start relative to the recording's stamp
  std::optional<PointTimeNature> times{};  ///< how the points' times were understood, where any are
  /// Red, green and blue of each point, where they were wanted and some point has one.
  std::vector<std::array<uint8_t, 3>> colors{};
  bool has_intensity = true;     ///< false: those of the points are made up zeros
  double coordinate_step = 0.0;  ///< m to the next float32, where the source's coordinates are
                                 ///< rounded to such; 0: within half a millimetre
  std::optional<uint32_t> floats_per_point{};  ///< of a .bin file, where it was given or found
  std::vector<InputError> faults{};  ///< damage of the file; the sweep is what could be read
};

/// A fault that was found so many times, in so many `things` ("lines").
InputError with_count(const InputError& first, std::size_t count, std::string_view things);

/// Reads the columns. A few points whose ring is no beam number, or whose time cannot be of the
/// same sweep, become NaN and a fault. Radial speeds count where they are float32 or float64: the
/// step of integers is not known. Throws InputError (with the point) where many are so or the
/// cloud is small, where coordinates are integers whose scale nothing tells, or where the cloud
/// lies farther than 16 km from `reading.offset` and has finer coordinates than float32.
CloudFile decode_cloud(const std::filesystem::path& file, const CloudColumns& columns);

}  // namespace adit
