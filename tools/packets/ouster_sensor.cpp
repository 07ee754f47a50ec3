// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/packets/ouster_sensor.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kMostBeams = 256;
constexpr std::size_t kMostColumns = 4096;

constexpr std::array kProfiles = {
    std::pair{"RNG19_RFL8_SIG16_NIR16", OusterProfile::rng19_rfl8_sig16_nir16},
    std::pair{"RNG19_RFL8_SIG16_NIR16_DUAL", OusterProfile::rng19_rfl8_sig16_nir16_dual},
    std::pair{"RNG15_RFL8_NIR8", OusterProfile::rng15_rfl8_nir8},
    std::pair{"RNG15_RFL8_NIR8_DUAL", OusterProfile::rng15_rfl8_nir8_dual},
    std::pair{"FUSA_RNG15_RFL8_NIR8_DUAL", OusterProfile::fusa_rng15_rfl8_nir8_dual}};

[[noreturn]] void fail(const fs::path& file, const std::string& entry, const std::string& found) {
  throw InputError(file, Place::named(entry), found,
                   "Save the sensor's metadata again (its HTTP API or recorder writes it)");
}

/// An entry at the top or in one of the sections that newer firmware has; null where there is none.
const json* find(const json& all, const char* name) {
  if (all.contains(name)) {
    return &all[name];
  }
  for (const auto& section : all) {
    if (section.is_object() && section.contains(name)) {
      return &section[name];
    }
  }
  return nullptr;
}

std::vector<double> angles(const fs::path& file, const json& all, const char* name) {
  const json* entry = find(all, name);
  if (entry == nullptr || !entry->is_array() || entry->empty() || entry->size() > kMostBeams) {
    fail(file, name, "expected an angle for each of up to 256 beams");
  }
  std::vector<double> radians;
  for (const json& one : *entry) {
    if (!one.is_number() || !(std::abs(one.get<double>()) <= 360.0)) {
      fail(file, name, "an angle that is none");
    }
    radians.push_back(one.get<double>() * kDegree);
  }
  return radians;
}

double number(const json& all, const char* name, double otherwise) {
  const json* entry = find(all, name);
  const double value = entry != nullptr && entry->is_number() ? entry->get<double>() : otherwise;
  return std::abs(value) < 1e6 ? value : otherwise;
}

std::string text(const json& all, const char* name) {
  const json* entry = find(all, name);
  return entry != nullptr && entry->is_string() ? entry->get<std::string>() : std::string();
}

/// Sixteen numbers row by row, translation in mm.
Eigen::Isometry3d transform(const fs::path& file, const json& all, const char* name,
                            const Eigen::Isometry3d& otherwise) {
  const json* entry = find(all, name);
  if (entry == nullptr) {
    return otherwise;
  }
  if (!entry->is_array() || entry->size() != 16) {
    fail(file, name, "expected 16 numbers, a transform row by row");
  }
  Eigen::Matrix4d m;
  for (std::size_t i = 0; i < 16; ++i) {
    if (!(*entry)[i].is_number()) {
      fail(file, name, "expected 16 numbers, a transform row by row");
    }
    m(static_cast<int>(i / 4), static_cast<int>(i % 4)) = (*entry)[i].get<double>();
  }
  const Eigen::Matrix3d R = m.topLeftCorner<3, 3>();
  if (!m.allFinite() || !(R * R.transpose()).isIdentity(1e-3) || R.determinant() < 0.0) {
    fail(file, name, "its rotation is none");
  }
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  T.translation() = 1e-3 * m.topRightCorner<3, 1>();
  return T;
}

/// "1024x10" to 1024.
std::size_t columns_of(const fs::path& file, const json& all) {
  const std::string mode = text(all, "lidar_mode");
  std::size_t columns = 0;
  const auto end = std::from_chars(mode.data(), mode.data() + mode.size(), columns);
  if (end.ec != std::errc() || columns < 16 || columns > kMostColumns) {
    fail(file, "lidar_mode", "'" + mode + "' is no mode such as 1024x10");
  }
  return columns;
}

OusterProfile profile_of(const fs::path& file, const json& all) {
  const std::string name = text(all, "udp_profile_lidar");
  if (name.empty() || name == "LEGACY") {
    return OusterProfile::legacy;
  }
  for (const auto& [known, profile] : kProfiles) {
    if (name == known) {
      return profile;
    }
  }
  throw InputError(file, Place::named("udp_profile_lidar"), "the profile " + name + " is not read",
                   "Configure the sensor for one of the profiles RNG19 or RNG15, single or dual, "
                   "or LEGACY");
}

}  // namespace

OusterPixel pixel_of(OusterProfile profile) {
  constexpr uint32_t kShort = 0x7fff;
  constexpr double kLow = 8e-3;  // m: low bandwidth counts in steps of 8 mm
  switch (profile) {
    case OusterProfile::legacy:
      return {12, 0xfffff, 1e-3, {{0, 6, 2}}};
    case OusterProfile::rng19_rfl8_sig16_nir16:
      return {12, 0x7ffff, 1e-3, {{0, 6, 2}}};
    case OusterProfile::rng19_rfl8_sig16_nir16_dual:
      return {16, 0x7ffff, 1e-3, {{0, 8, 2}, {4, 10, 2}}};
    case OusterProfile::rng15_rfl8_nir8:
      return {4, kShort, kLow, {{0, 2, 1}}};
    case OusterProfile::rng15_rfl8_nir8_dual:
    case OusterProfile::fusa_rng15_rfl8_nir8_dual:
      return {8, kShort, kLow, {{0, 2, 1}, {4, 6, 1}}};
  }
  return {};
}

std::size_t OusterSensor::column_bytes() const {
  const std::size_t pixels = pixel_of(profile).bytes * beams;
  return profile == OusterProfile::legacy ? 16 + pixels + 4 : 12 + pixels;
}

std::size_t OusterSensor::packet_bytes() const {
  return columns_per_packet * column_bytes() + (profile == OusterProfile::legacy ? 0 : 64);
}

OusterSensor read_ouster_sensor(const fs::path& file) {
  return parse_ouster_sensor(file, read_text_file(file));
}

OusterSensor parse_ouster_sensor(const fs::path& file, const std::string& content) {
  const json all = json::parse(content, nullptr, false);
  if (!all.is_object()) {
    throw InputError(file, {}, "it is no JSON object", "Save the sensor's metadata again");
  }
  OusterSensor sensor;
  sensor.profile = profile_of(file, all);
  const std::string header = text(all, "header_type");
  sensor.fusa_header = header.empty() ? sensor.profile == OusterProfile::fusa_rng15_rfl8_nir8_dual
                                      : header == "FUSA";
  sensor.beam_altitudes = angles(file, all, "beam_altitude_angles");
  sensor.beam_azimuths = angles(file, all, "beam_azimuth_angles");
  sensor.beams = sensor.beam_altitudes.size();
  if (sensor.beam_azimuths.size() != sensor.beams) {
    fail(file, "beam_azimuth_angles",
         std::to_string(sensor.beam_azimuths.size()) + " angles; there are " +
             std::to_string(sensor.beams) + " altitudes");
  }
  sensor.columns = columns_of(file, all);
  const double packet = number(all, "columns_per_packet", 16.0);
  if (!(packet >= 1.0 && packet <= 64.0)) {
    fail(file, "columns_per_packet", "is not between 1 and 64");
  }
  sensor.columns_per_packet = static_cast<std::size_t>(packet);
  sensor.beam_origin = 1e-3 * number(all, "lidar_origin_to_beam_origin_mm", 0.0);
  Eigen::Isometry3d half_turn = Eigen::Isometry3d::Identity();
  half_turn.linear().diagonal() << -1.0, -1.0, 1.0;
  half_turn.translation().z() = 0.03618;
  sensor.T_sensor_lidar = transform(file, all, "lidar_to_sensor_transform", half_turn);
  Eigen::Isometry3d imu = Eigen::Isometry3d::Identity();
  imu.translation() << 0.006253, -0.011775, 0.007645;
  sensor.T_sensor_imu = transform(file, all, "imu_to_sensor_transform", imu);
  return sensor;
}

fs::path find_ouster_metadata(const fs::path& capture) {
  fs::path beside = capture;
  beside.replace_extension(".json");
  std::error_code error;
  if (fs::is_regular_file(beside, error)) {
    return beside;
  }
  fs::path found;
  const fs::path folder = capture.has_parent_path() ? capture.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;
    constexpr uint64_t kLargest = 1U << 20U;
    if (entry->path().extension() != ".json" || entry->file_size(ignored) > kLargest || ignored ||
        read_text_file(entry->path()).find("beam_altitude_angles") == std::string::npos) {
      continue;
    }
    if (!found.empty()) {
      return {};  // whose is it?
    }
    found = entry->path();
  }
  return found;
}

}  // namespace adit
