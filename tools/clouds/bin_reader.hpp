// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds of float32 numbers without a header (.bin): KITTI's x y z intensity, and those of others
// with three to eight numbers a point.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "adit/tools/clouds/cloud_columns.hpp"

namespace adit {

/// How many numbers a point has, 3 to 8, by how much a number's place in its point tells of it:
/// x, y and z have both signs, an intensity has one, a ring is whole. With any other number of
/// places these mix. None where the numbers show no such order.
std::optional<uint32_t> find_floats_per_point(std::span<const float> numbers);

/// Reads a cloud: x y z intensity, of three numbers without intensity. Of five to eight, a column
/// of whole numbers from 0 to 255 is the ring and one that rises from 0, or to 0, is the time; the
/// others are left out. `reading.floats_per_point`, where it is given, is believed. A file that
/// ends within a point is a fault. Throws InputError where nothing shows how many numbers a point
/// has, and the file is no whole number of KITTI's points.
CloudFile read_bin(const std::filesystem::path& file, const CloudReading& reading = {});

/// The same from memory; `file` is for messages.
CloudFile parse_bin(const std::filesystem::path& file, std::string_view content,
                    const CloudReading& reading = {});

/// For people: what the numbers of a file look like, where that is not KITTI's layout; else empty.
std::string describe_bin(const std::filesystem::path& file);

}  // namespace adit
