// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

/// How a pixel is laid out; the names are those of the sensor's setting udp_profile_lidar.
enum class OusterProfile {
  legacy,
  rng19_rfl8_sig16_nir16,
  rng19_rfl8_sig16_nir16_dual,
  rng15_rfl8_nir8,
  rng15_rfl8_nir8_dual,
  fusa_rng15_rfl8_nir8_dual,
};

/// Where the numbers of a return lie in a pixel.
struct OusterReturn {
  std::size_t range_at = 0;         ///< 32 bits, little-endian, of which `range_mask` count
  std::size_t intensity_at = 0;     ///< signal photons, or reflectivity where there are none
  std::size_t intensity_bytes = 2;  ///< 1 or 2
};

struct OusterPixel {
  std::size_t bytes = 12;
  uint32_t range_mask = 0x7ffff;
  double range_unit = 1e-3;             ///< m
  std::vector<OusterReturn> returns{};  ///< the stronger one first
};
OusterPixel pixel_of(OusterProfile profile);

/// What an Ouster sensor says of itself (its metadata in JSON): how its packets are laid out and
/// where its beams point.
struct OusterSensor {
  OusterProfile profile = OusterProfile::legacy;
  bool fusa_header = false;  ///< packets begin as functional safety wants it
  std::size_t beams = 0;
  std::size_t columns_per_packet = 16;
  std::size_t columns = 0;               ///< per turn
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

/// The same of a text; `file` is for messages.
OusterSensor parse_ouster_sensor(const std::filesystem::path& file, const std::string& content);

/// The metadata beside a capture: NAME.json for NAME.pcap, else the one JSON file of the folder
/// that has beam angles. Empty where there is none.
std::filesystem::path find_ouster_metadata(const std::filesystem::path& capture);

}  // namespace adit
