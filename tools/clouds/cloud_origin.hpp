// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Clouds in large coordinates, such as UTM: where they lie, and what float32 makes of them.
#pragma once

#include <filesystem>
#include <string>

#include <Eigen/Core>

#include "adit/tools/clouds/cloud_columns.hpp"

namespace adit {

/// Where a cloud lies, and how fine its coordinates are there.
struct CloudOrigin {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Sweep::offset
  double step = 0.0;                                 ///< CloudFile::coordinate_step
};

/// By the medians of some of its returns. Where `reading.offset` is not given, the offset is zero
/// for clouds whose median is within 8 km of the origin, else that median, rounded to metres.
/// Throws InputError where the cloud is too far from the given offset.
CloudOrigin find_origin(const std::filesystem::path& file, const CloudColumns& columns);

/// "(430012, 5400003, 301) m".
std::string offset_text(const Eigen::Vector3d& offset);

/// For people: what is subtracted, and what that means.
std::string offset_note(const Eigen::Vector3d& offset);

/// For people: how coarse the coordinates are, and what to do about it.
std::string coarse_note(double step);

}  // namespace adit
