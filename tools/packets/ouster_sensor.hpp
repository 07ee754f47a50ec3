// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

enum class OusterProfile { legacy, rng19_rfl8_sig16_nir16 };

/// What an Ouster sensor says of itself (its metadata in JSON): how its packets are laid out and
/// where its beams point.
struct OusterSensor {
  OusterProfile profile = OusterProfile::legacy;
  std::size_t beams = 0;
  std::size_t columns_per_packet = 16;
  std::size_t columns = 0;               ///< of a turn
  double beam_origin = 0.0;              ///< m, from the axis to where the beams begin
  std::vector<double> beam_altitudes{};  ///< rad, from the uppermost beam down
  std::vector<double> beam_azimuths{};   ///< rad
  Eigen::Isometry3d T_sensor_lidar = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_sensor_imu = Eigen::Isometry3d::Identity();

  std::size_t column_bytes() const;
  std::size_t packet_bytes() const;
};

/// Reads the metadata, as firmware 1.12 to 3.1 write it: flat, or in sections. Throws InputError:
/// no JSON, an entry that is missing or makes no sense, a profile that is not read.
OusterSensor read_ouster_sensor(const std::filesystem::path& file);

/// The metadata beside a capture: NAME.json for NAME.pcap, else the one JSON file of the folder
/// that has beam angles. Empty where there is none.
std::filesystem::path find_ouster_metadata(const std::filesystem::path& capture);

}  // namespace adit
