// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/presets.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <string_view>

#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

struct Preset {
  std::string_view name;
  std::optional<std::string_view> sweep_topic{};  ///< none: the only one
  std::optional<std::string_view> imu_topic{};
  /// imu.T_imu_lidar; nothing where the recordings' own transforms, or the user, must tell it.
  std::optional<std::array<double, 7>> T_imu_lidar{};
  double spin_rate = 0.0;       ///< Hz, recording.spin_rate
  double beam_elevation = 0.0;  ///< rad, recording.beam_elevation
};

// Ouster sensors by their design: points in the frame of the lidar (os_lidar, gen. 1 drivers) or of
// the housing (os_sensor); Newer College's multi-camera release by its own calibration.
constexpr std::array<double, 7> kOusterLidar = {-0.006253, 0.011775, 0.028535, 0.0, 0.0, 1.0, 0.0};
constexpr std::array<double, 7> kNewerCollege2021 = {0.014, -0.012, -0.015, 0.0, 0.0, 0.0, 1.0};
constexpr std::array<double, 7> kHilti2022 = {-0.001,      -0.00855, 0.055, 0.70710678,
                                              -0.70710678, 0.0,      0.0};

// The calibration of KITTI's HDL-64E is off by 0.205 degrees (J.-E. Deschaud, "IMLS-SLAM", ICRA
// 2018), and its turns last 103.7 ms (the stamps of raw drives).
constexpr double kKittiElevation = 0.205 * std::numbers::pi / 180.0;
constexpr double kKittiSpin = -9.64;

constexpr std::array<Preset, 8> kPresets = {{
    {"hilti-2021", "/os_cloud_node/points", "/os_cloud_node/imu"},
    {"hilti-2022", "/hesai/pandar", "/alphasense/imu", kHilti2022},
    {.name = "kitti", .beam_elevation = kKittiElevation},
    {.name = "kitti-raw", .spin_rate = kKittiSpin, .beam_elevation = kKittiElevation},
    {"mulran"},
    {"newer-college", "/os1_cloud_node/points", "/os1_cloud_node/imu", kOusterLidar},
    {"newer-college-multi-camera", "/os_cloud_node/points", "/os_cloud_node/imu",
     kNewerCollege2021},
    {"subt-mrs"},
}};

}  // namespace

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : kPresets) {
    names.emplace_back(preset.name);
  }
  return names;
}

void apply_preset(const std::string& name, Config& config) {
  const auto preset = std::ranges::find(kPresets, name, &Preset::name);
  if (preset == kPresets.end()) {
    throw UsageError("--preset " + name + ": there is no such preset. " +
                     suggestion(name, preset_names()) + ".");
  }
  config.recording.sweep_topic = preset->sweep_topic;
  config.recording.imu_topic = preset->imu_topic;
  if (preset->T_imu_lidar) {
    config.imu.T_imu_lidar = preset->T_imu_lidar;
  }
  config.recording.spin_rate = preset->spin_rate;
  config.recording.beam_elevation = preset->beam_elevation;
}

}  // namespace adit
