// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Maps of drives along simulated streets, for tests of what maps have in common.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "adit/slam/executor/slam.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/setup/config_file.hpp"

namespace adit::test {

/// A drive of 0.5 m a sweep.
struct StreetDrive {
  uint64_t street = 1;  ///< seed: others are other streets
  double from = 0.0;    ///< m, along the street
  double aside = 0.0;   ///< m
  std::size_t sweeps = 60;
  std::vector<Block> more{};  ///< what stands there besides
  Nanoseconds later{0};       ///< than the others it begins
};

inline SubmapDrive street_drive(const StreetDrive& asked) {
  SubmapDrive drive{.truth = steady_drive(asked.sweeps, twist(0.5)), .sweeps = {}};
  for (StampedPose& pose : drive.truth) {
    pose.stamp += asked.later;
    pose.pose = Eigen::Translation3d(asked.from, asked.aside, 0.0) * pose.pose;
  }
  World street = make_street(80.0, asked.street);
  street.blocks.insert(street.blocks.end(), asked.more.begin(), asked.more.end());
  drive.sweeps = scan_all(street, drive.truth, small_lidar());
  return drive;
}

/// The map of the drive in a file of its own. Its session says which recording it is of.
inline void write_street_map(engine::Context& context, const std::filesystem::path& file,
                             const StreetDrive& drive) {
  const Config config = loop_config(true);
  const std::string name = file.stem().string();
  MapDatabase store(file, MapAccess::write);
  const SessionId session = store.add_session({.name = name,
                                               .configuration = to_toml(config),
                                               .provenance = {{"recording fingerprint", name}}});
  store.begin_run(session);
  const auto slam =
      make_slam(context, config, {.inertial = false, .map = &store, .session = session});
  for (const Sweep& sweep : street_drive(drive).sweeps) {
    slam->add(sweep);
    while (slam->next()) {
    }
  }
  slam->finish_map();
  store.set_complete(session);
}

}  // namespace adit::test
