// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Times of sweeps: from files with one time a line, and from file names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

/// One time a line: seconds ("0.110", "1.036224e-01"), or date and time of day as in KITTI raw
/// ("2011-09-26 13:02:25.594360375"; taken as UTC). Blank lines at the end do not count. Throws
/// InputError with the line: not a time, or, unless any order will do, not after the one before.
enum class TimesOrder { increasing, any };
std::vector<Nanoseconds> read_times(const std::filesystem::path& file,
                                    TimesOrder order = TimesOrder::increasing);

/// Throws InputError unless there are as many times as things to stamp. `things` completes "for N
/// ...".
void require_matching_times(const std::filesystem::path& file, std::size_t times,
                            std::size_t needed, const std::string& things);

/// The time a file's name tells, if it does: "1623370000.123", "cloud_1623370000_123456789"
/// (seconds and nanoseconds), 19 digits (nanoseconds) or 16 (microseconds). A plain number such as
/// "000042" is an index, no time.
std::optional<Nanoseconds> time_from_name(std::string_view stem);

/// Order in which numbers inside names count as numbers: "2.pcd" before "10.pcd".
bool natural_less(std::string_view a, std::string_view b);

}  // namespace adit
