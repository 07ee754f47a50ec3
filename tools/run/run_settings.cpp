// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/run_settings.hpp"

#include <fmt/core.h>

#include "adit/tools/recordings/packet_messages.hpp"
#include "adit/tools/setup/static_transforms.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr const char* kMountingIsAssumed =
    "note: how the IMU is mounted is not told; its axes are taken for the lidar's "
    "(imu.T_imu_lidar; "
    "imu.use=false leaves it out)\n";

}  // namespace

void require_packets(const ConfigSource& source, const std::filesystem::path& recording) {
  if (source.metadata && !holds_packets(recording)) {
    throw UsageError("--metadata " + *source.metadata + ": it tells of a sensor's packets, and " +
                     recording.string() + " holds none; leave it out.");
  }
}

Config with_mounting(Config config, const std::optional<Mounting>& mounting) {
  if (mounting) {
    config.imu.T_imu_lidar = numbers_of(mounting->T_imu_lidar);
  }
  return config;
}

std::string as_notes(const std::vector<std::string>& texts) {
  std::string notes;
  for (const std::string& text : texts) {
    notes += "note: " + text + "\n";
  }
  return notes;
}

std::string notes_of(const Config& stated, const Config& used,
                     const std::optional<Mounting>& mounting) {
  std::string notes;
  const double farthest = stated.preprocess.c_max;
  if (farthest != PreprocessConfig{}.c_max && used.preprocess.c_max < farthest) {
    notes += fmt::format(
        "note: returns beyond {:.1f} m were dropped, not beyond the {:g} m of preprocess.c_max: "
        "voxels of {:g} m reach no farther (registration.r_align sets larger ones)\n",
        used.preprocess.c_max, farthest, used.registration.r_align);
  }
  if (mounting && mounting->source == MountingSource::assumed) {
    notes += kMountingIsAssumed;
  }
  if (mounting && mounting->conflict) {
    notes += "note: " + describe(*mounting->conflict, "the IMU on the range sensor") +
             "; set imu.T_imu_lidar to choose\n";
  }
  return notes;
}

}  // namespace adit
