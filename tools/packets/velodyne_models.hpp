// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

namespace adit {

/// How a Velodyne fires: all its lasers once a firing sequence, one sequence after the other.
struct VelodyneModel {
  static constexpr std::size_t kMostLasers = 128;

  std::string_view name{};
  std::size_t lasers = 0;
  double range_unit = 0.0;    ///< m
  double cycle = 0.0;         ///< s from a firing sequence to the next
  double first_firing = 0.0;  ///< s from a packet's time to its first firing
  // By laser, in the order of a packet:
  std::array<double, kMostLasers> elevation{};  ///< degrees, up
  std::array<double, kMostLasers> azimuth{};    ///< degrees, added to the packet's
  std::array<double, kMostLasers> height{};     ///< m, of the laser over the sensor's centre
  std::array<double, kMostLasers> firing{};     ///< s after the sequence began
  std::array<uint16_t, kMostLasers> rings{};    ///< from the lowest up
};

/// The model that the last byte of a data packet names; null for one that is not read. Figures are
/// those of Velodyne's manuals (63-9243, 63-9113, 63-9325, 63-9483), the angles of VLP-32C and
/// VLS-128 in the form in which VeloView's calibration files publish them. The radii of the rings
/// of lasers of these two are those of velodyne-decoder.
const VelodyneModel* find_velodyne_model(unsigned factory_byte);

}  // namespace adit
