// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Single clouds out of files and recordings, and lists of pairs of them.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// A pose out of 4 numbers, x y z (m) and the yaw about z (degrees), or 7: x y z (m) and a
/// quaternion x y z w of any length. None where it is neither, or no pose.
std::optional<Eigen::Isometry3d> pose_of_numbers(std::span<const double> numbers);

/// Two clouds by their names, as read_cloud() takes them.
struct NamedPair {
  std::string a;
  std::string b;
  std::optional<Eigen::Isometry3d> guess{};  ///< T_a_b, where one is given
};

/// Reads a list of pairs: on each line the names of two clouds and then nothing or a pose of 4 or 7
/// numbers, T_a_b. Names with blanks stand in double quotes, relative ones count from the list's
/// folder; what follows a # is left out. Throws InputError with the line.
std::vector<NamedPair> read_pairs(const std::filesystem::path& file);

/// Reads the cloud that is named: a file of points, or of a recording its first sweep; NAME@N is
/// the recording's sweep N, counted from 0. `damage` hears of what is left out. Throws InputError
/// where there is none, where it has no points, or where their coordinates are coarse: rounded to
/// float32 far from the origin.
Sweep read_cloud(const std::string& name,
                 const std::function<void(const InputError&)>& damage = {});

}  // namespace adit
