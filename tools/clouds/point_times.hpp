// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Drivers write the time of a point in seconds, milli-, micro- or nanoseconds, counted from the
// sweep's stamp, from its end, or from an epoch, and do not say which. The spread of one sweep
// (0.01 to 1 s) tells the unit, the earliest value tells the zero.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

/// s. A sweep of a spinning sensor or a Livox lasts 0.01 to 1 s.
inline constexpr double kLongestSweep = 10.0;

/// How the times of a sweep's points were understood.
struct PointTimeNature {
  std::string field;      ///< its name
  double unit = 1.0;      ///< s, of a step of one
  bool absolute = false;  ///< counted from an epoch, not from the sweep's own stamp
  double first = 0.0;     ///< s, of the earliest point after that stamp; 0 where absolute
};

struct PointTimes {
  Nanoseconds start{
      0};  ///< earliest time: of the recording's clock if absolute, else relative to the stamp
  bool absolute = false;       ///< 1 s or more after zero, or 10 s before it
  double unit = 1.0;           ///< s, of a step of one
  std::vector<float> offsets;  ///< s after `start`, one a point, none negative
};

/// So few of so many points may be damaged and left out: a tenth, of 20 points or more.
bool are_few(std::size_t bad, std::size_t points);

/// Points, among those with valid[i] != 0, whose time cannot be of the same sweep as the times of
/// nearly all others: not finite, or a hundred times as far from the middle nine tenths as these
/// spread. None where they are more than a few. `unit`: s, where it is known.
std::vector<std::size_t> impossible_times(std::span<const double> times,
                                          std::span<const uint8_t> valid,
                                          std::optional<double> unit = {});
std::vector<std::size_t> impossible_times(std::span<const int64_t> times,
                                          std::span<const uint8_t> valid,
                                          std::optional<double> unit = {});

/// Interprets one sweep's times. Only points with valid[i] != 0 count for the unit and the start;
/// the others' times are brought into the sweep. Throws InputError (with the point): not finite for
/// a valid point, farther apart than one sweep lasts, or absolute in single precision, which cannot
/// hold them. `unit` (s) is that of the times; without it, it is inferred from them. `longest`: s.
PointTimes interpret_times(const std::filesystem::path& file, std::span<const double> times,
                           std::span<const uint8_t> valid, bool single_precision,
                           std::optional<double> unit = {}, double longest = kLongestSweep);
PointTimes interpret_times(const std::filesystem::path& file, std::span<const int64_t> times,
                           std::span<const uint8_t> valid, std::optional<double> unit = {},
                           double longest = kLongestSweep);

}  // namespace adit
